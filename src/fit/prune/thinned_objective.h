#ifndef TRILOBE_FIT_PRUNE_THINNED_OBJECTIVE_H_
#define TRILOBE_FIT_PRUNE_THINNED_OBJECTIVE_H_

#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Samples to keep per parameter, and the largest stride.
struct SampleThinning {
  int samples_per_parameter, max_stride;
};

// Enough samples for a fit close to that of all samples.
inline constexpr SampleThinning kSomeSamples{.samples_per_parameter = 100, .max_stride = 24};

// Few samples, to compare forms: a joint step takes hardly longer than its linear algebra.
inline constexpr SampleThinning kFewSamples{.samples_per_parameter = 32, .max_stride = 72};

// The objective of a part of the samples. At angles with few samples more of them are kept, so that
// every entry stays determined. Weights are multiplied by the stride, so that E is about that of
// all samples.
Objective ThinnedObjective(const Objective& objective, int num_parameters,
                           const SampleThinning& thinning);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_THINNED_OBJECTIVE_H_
