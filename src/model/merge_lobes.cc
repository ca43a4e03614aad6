#include "trilobe/model/merge_lobes.h"

#include <algorithm>
#include <string>

#include "trilobe/base/error.h"

namespace trilobe {
namespace {

void CheckLobe(const FactorModel& model, int lobe) {
  if (lobe >= 0 && lobe < model.spec().lobes) return;
  throw Error("there is no lobe " + std::to_string(lobe) + ": the model has " +
              std::to_string(model.spec().lobes));
}

// Sum of s in the channels of a table.
double Size(const FactorModel& model, int lobe, ModelSpec::ChannelRange channels) {
  double sum = 0;
  for (int c = channels.begin; c < channels.end; ++c) sum += model.s(lobe)[c];
  return sum;
}

}  // namespace

FactorModel WithoutLobe(const FactorModel& model, int lobe) {
  CheckLobe(model, lobe);
  ModelSpec spec = model.spec();
  --spec.lobes;
  FactorModel result(spec);
  std::ranges::copy(model.d(), result.d().begin());
  for (int m = 0; m < spec.lobes; ++m) {
    const int from = m < lobe ? m : m + 1;
    std::ranges::copy(model.s(from), result.s(m).begin());
    for (const Factor factor : kFactors) {
      for (int c = 0; c < kChannels; ++c) {
        std::ranges::copy(model.table(factor, model.spec().table(factor, from, c)),
                          result.table(factor, spec.table(factor, m, c)).begin());
      }
    }
  }
  return result;
}

FactorModel WithLobesMerged(const FactorModel& model, int lobe, int other) {
  CheckLobe(model, lobe);
  CheckLobe(model, other);
  if (lobe == other) throw Error("a lobe cannot be merged with itself");
  const ModelSpec& spec = model.spec();
  FactorModel merged = model;
  for (const Factor factor : kFactors) {
    if (!spec.sharing(factor).per_lobe) continue;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto channels = spec.channels(factor, t);
      if (!spec.serves(factor, t, lobe, channels.begin)) continue;
      const double mine = Size(model, lobe, channels), others = Size(model, other, channels);
      const double share = mine + others > 0 ? others / (mine + others) : 0;
      const auto with = model.table(factor, spec.table(factor, other, channels.begin));
      const auto to = merged.table(factor, t);
      for (size_t k = 0; k < to.size(); ++k) to[k] += share * (with[k] - to[k]);
    }
  }
  for (int c = 0; c < kChannels; ++c) merged.s(lobe)[c] += model.s(other)[c];
  return WithoutLobe(merged, other);
}

}  // namespace trilobe
