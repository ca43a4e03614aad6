#include <algorithm>
#include <cmath>
#include <vector>

#include "trilobe/core/base/error.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe {

BrdfSamples Reweighted(const Objective& objective, const FactorModel& model, double delta) {
  CheckSameSpec(objective.spec(), model.spec());
  if (!(delta > 0)) {
    throw Error(ErrorKind::kRange, "the error from which a loss is linear must be above 0")
        .About("delta", delta);
  }
  BrdfSamples samples = objective.samples();
  const std::vector<Rgb> fitted = UnclampedSamples(model, samples, objective.num_threads());
  const double level = objective.weighting().level;
  const double unit = level > 0 ? level : 1;
  samples.multiplicity.resize(samples.rho.size());
  for (int j = 0; j < samples.size(); ++j) {
    // In units of the level if the weighting uses it. Without the solid angle, which is a number of
    // samples and not an error.
    const Rgb w = objective.weighting()({samples.rho[j], samples.CosinesOf(j)});
    double square = 0;
    for (int c = 0; c < kChannels; ++c) {
      const double difference = fitted[j][c] - samples.rho[j][c];
      square += w[c] * difference * difference / kChannels;
    }
    samples.multiplicity[j] =
        objective.samples().Multiplicity(j) * std::min(1.0, delta * unit / std::sqrt(square));
  }
  return samples;
}

}  // namespace trilobe
