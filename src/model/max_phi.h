#ifndef TRILOBE_MODEL_MAX_PHI_H_
#define TRILOBE_MODEL_MAX_PHI_H_

#include "core/base/lanes.h"
#include "trilobe/core/base/angles.h"

namespace trilobe {

// The azimuth [rad] between half vector and wi up to which wo is above the surface:
//   0 < cos theta_o = 2 (wi . h) cos theta_h - cos theta_i.
template <typename Real>
Real MaxPhi(Real cos_i, Real sin_i, Real cos_h, Real sin_h) {
  const Real denominator = 2 * sin_h * cos_h * sin_i;
  const Real numerator = -cos_i * (2 * cos_h * cos_h - 1);
  if (numerator <= -denominator) return static_cast<Real>(kPi);
  return numerator >= denominator ? Real{0} : AngleOfCosine(numerator / denominator);
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MAX_PHI_H_
