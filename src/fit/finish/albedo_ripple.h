#ifndef TRILOBE_FIT_FINISH_ALBEDO_RIPPLE_H_
#define TRILOBE_FIT_FINISH_ALBEDO_RIPPLE_H_

#include "trilobe/model/factor_model.h"

namespace trilobe {

struct AlbedoRipple {
  double share = 0, theta_i = 0;  // [rad]
};

// Least ripple, to one side of the course, that uniform light shows as rings.
inline constexpr double kSeenRipple = 0.01;

// Largest relative deviation of the directional albedo of an isotropic model from its course: at
// each half degree up to 65 degrees, the distance from the parabola through the values within 2
// degrees, by least squares of the logarithms (Savitzky and Golay, Analytical Chemistry 36, 1964).
// Values at bins' centers hardly show tables that alternate from entry to entry, which cause this.
// Zero for an anisotropic model. The same bits for any number of threads.
AlbedoRipple RippleOf(const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_ALBEDO_RIPPLE_H_
