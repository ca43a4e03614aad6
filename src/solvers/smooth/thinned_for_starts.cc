#include "solvers/smooth/thinned_for_starts.h"

#include <algorithm>

#include "trilobe/brdf/brdf_samples.h"

namespace trilobe {

Objective ThinnedForStarts(const Objective& objective) {
  // With fewer samples, work that every (theta_h, theta_d) takes, however few its samples, rules
  // the time.
  constexpr int kSamplesPerParameter = 25, kMaxStride = 24;
  const int fold = objective.samples().on_grid() ? 2 : 1;  // folded samples are half as many
  const int wanted = fold * kSamplesPerParameter * objective.spec().num_parameters();
  const int stride = std::clamp(objective.samples().size() / std::max(wanted, 1), 1, kMaxStride);
  return {Thinned(objective.samples(), stride), objective.spec(), objective.weighting(), 1};
}

}  // namespace trilobe
