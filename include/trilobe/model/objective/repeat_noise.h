#ifndef TRILOBE_MODEL_OBJECTIVE_REPEAT_NOISE_H_
#define TRILOBE_MODEL_OBJECTIVE_REPEAT_NOISE_H_

#include <optional>

#include "trilobe/model/objective/objective.h"

namespace trilobe {

// The part of E that noise alone leaves, estimated from samples of the same pair of directions:
// repeated ones and, for an isotropic spec, those with light and eye exchanged.
struct RepeatNoise {
  int samples = 0;  // that have another of the same directions
  // The expected E of a perfect model at these, over a black model's: their variance, unbiased.
  double relative_objective = 0;
};

// Nothing if no samples repeat, or all that do agree but for rounding, as copies do.
std::optional<RepeatNoise> NoiseOfRepeats(const Objective& data);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_REPEAT_NOISE_H_
