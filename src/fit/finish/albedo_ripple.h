#ifndef TRILOBE_FIT_FINISH_ALBEDO_RIPPLE_H_
#define TRILOBE_FIT_FINISH_ALBEDO_RIPPLE_H_

#include "trilobe/model/factor_model.h"

namespace trilobe {

struct AlbedoRipple {
  double share = 0, theta_i = 0;  // [rad]
};

// How much the directional albedo of an isotropic model jumps from entry to entry of G up to 65
// degrees, of which even light makes rings: the largest relative distance from a robust line over
// the entries within 5 degrees. Beyond, Fresnel factors rise in a curve. Zero for an anisotropic
// model. The same bits for any number of threads.
AlbedoRipple RippleOf(const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_ALBEDO_RIPPLE_H_
