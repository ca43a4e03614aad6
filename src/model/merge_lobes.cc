#include "trilobe/model/merge_lobes.h"

#include <numeric>
#include <vector>

#include "trilobe/base/error.h"
#include "trilobe/model/with_lobes.h"

namespace trilobe {
namespace {

// Sum of s in the channels of a table.
double Size(const FactorModel& model, int lobe, ModelSpec::ChannelRange channels) {
  double sum = 0;
  for (int c = channels.begin; c < channels.end; ++c) sum += model.s(lobe)[c];
  return sum;
}

}  // namespace

FactorModel WithoutLobe(const FactorModel& model, int lobe) {
  CheckLobe(model, lobe);
  std::vector<int> others(model.spec().lobes);
  std::iota(others.begin(), others.end(), 0);
  others.erase(others.begin() + lobe);
  return WithLobes(model, others);
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
