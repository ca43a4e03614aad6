#ifndef TRILOBE_FIT_PRUNE_THINNED_OBJECTIVE_H_
#define TRILOBE_FIT_PRUNE_THINNED_OBJECTIVE_H_

#include "trilobe/model/objective/objective.h"

namespace trilobe {

// How many samples are left for each parameter, and of how many one at the least.
struct SampleThinning {
  int samples_per_parameter, max_stride;
};

// So many that what a model makes of them is nearly what it makes of all.
inline constexpr SampleThinning kSomeSamples{.samples_per_parameter = 100, .max_stride = 24};

// So few that a joint step takes hardly longer than its algebra: they tell which form E wants.
inline constexpr SampleThinning kFewSamples{.samples_per_parameter = 32, .max_stride = 72};

// The objective of some of the samples, more at angles that few have: an entry that is read by none
// of those left could be anything, and for all samples the model would be far off. Each counts for
// its stride, so that E is about that of all.
Objective ThinnedObjective(const Objective& objective, int num_parameters,
                           const SampleThinning& thinning);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_THINNED_OBJECTIVE_H_
