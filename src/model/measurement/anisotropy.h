#ifndef TRILOBE_MODEL_MEASUREMENT_ANISOTROPY_H_
#define TRILOBE_MODEL_MEASUREMENT_ANISOTROPY_H_

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Change of a material when rotated about its normal.
struct Anisotropy {
  int samples = 0;   // those that have another one with the material turned
  double share = 0;  // fraction of energy not explained by the mean over rotations
};

// For scattered samples, among those of equal theta_i, theta_o and phi_o - phi_i, to 1e-6,
//   share = Sum c^2 (rho - mean)^2 / Sum c^2 rho^2, c = cos theta_i cos theta_o,
// over samples and channels: a fraction of the visible energy, as cos theta_i weights the incident
// light and cos theta_o the visible surface. Includes noise.
Anisotropy AnisotropyOf(const Measurement& scattered);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_ANISOTROPY_H_
