#include "trilobe/model/with_lobes.h"

#include <algorithm>
#include <string>

#include "trilobe/base/error.h"

namespace trilobe {

void CheckLobe(const FactorModel& model, int lobe) {
  if (lobe >= 0 && lobe < model.spec().lobes) return;
  throw Error("there is no lobe " + std::to_string(lobe) + ": the model has " +
              std::to_string(model.spec().lobes));
}

FactorModel WithLobes(const FactorModel& model, std::span<const int> lobes) {
  for (const int lobe : lobes) CheckLobe(model, lobe);
  ModelSpec spec = model.spec();
  spec.lobes = static_cast<int>(lobes.size());
  FactorModel result(spec);
  std::ranges::copy(model.d(), result.d().begin());
  for (int m = 0; m < spec.lobes; ++m) {
    std::ranges::copy(model.s(lobes[m]), result.s(m).begin());
    for (const Factor factor : kFactors) {
      for (int c = 0; c < kChannels; ++c) {
        std::ranges::copy(model.table(factor, model.spec().table(factor, lobes[m], c)),
                          result.table(factor, spec.table(factor, m, c)).begin());
      }
    }
  }
  return result;
}

}  // namespace trilobe
