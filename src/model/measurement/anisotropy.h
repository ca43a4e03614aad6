#ifndef TRILOBE_MODEL_MEASUREMENT_ANISOTROPY_H_
#define TRILOBE_MODEL_MEASUREMENT_ANISOTROPY_H_

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// How much of what a material shows depends on how it is turned about its normal.
struct Anisotropy {
  int samples = 0;   // those that have another one with the material turned
  double share = 0;  // of their energy that is not that of the mean over all turns, 0 to 1
};

// Of scattered samples: among those of the same theta_i, theta_o and phi_o - phi_i, to 1e-6,
//   share = Sum c^2 (rho - mean)^2 / Sum c^2 rho^2, c = cos theta_i cos theta_o,
// over samples and channels: the energy of what is seen, as light of theta_i counts by its cosine
// and the surface that is seen by that of theta_o. Noise counts as anisotropy.
Anisotropy AnisotropyOf(const Measurement& scattered);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_ANISOTROPY_H_
