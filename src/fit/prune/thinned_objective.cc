#include "fit/prune/thinned_objective.h"

#include <algorithm>

#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

Objective ThinnedObjective(const Objective& objective, int num_parameters,
                           const SampleThinning& thinning) {
  constexpr int kLeast = 16;  // samples a place, as many times as there are for each parameter
  const int wanted = thinning.samples_per_parameter * std::max(num_parameters, 1);
  const int stride = std::clamp(objective.samples().size() / wanted, 1, thinning.max_stride);
  if (stride == 1) return objective;
  return {ThinnedByPlace(objective.samples(), stride, kLeast * thinning.samples_per_parameter),
          objective.spec(), objective.weighting(), objective.num_threads()};
}

}  // namespace trilobe
