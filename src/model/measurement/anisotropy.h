#ifndef TRILOBE_MODEL_MEASUREMENT_ANISOTROPY_H_
#define TRILOBE_MODEL_MEASUREMENT_ANISOTROPY_H_

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Change of a material when rotated about its normal.
struct Anisotropy {
  int samples = 0;   // those that have another one with the material turned
  double share = 0;  // fraction of energy not explained by the mean over rotations

  // The same without noise, by samples whose neighbour in azimuth is at most 15 degrees away.
  int with_neighbours = 0;        // their number
  double smooth_share = 0;        // below 0 by chance, where there is only noise
  double smooth_share_error = 0;  // four standard errors, if noise differs from sample to sample
};

// For scattered samples, among those of equal theta_i, theta_o and phi_o - phi_i, to 1e-6,
//   share = Sum c^2 (rho - mean)^2 / Sum c^2 rho^2, c = cos theta_i cos theta_o,
// over samples and channels: a fraction of the visible energy, as cos theta_i weights the incident
// light and cos theta_o the visible surface. Includes noise. Noise differs from one azimuth to the
// next and the material hardly does, so that with r_k = c (rho - mean) at successive azimuths of
// one group of samples
//   smooth_share = Sum r_k r_(k+1) / Sum c^2 rho^2.
Anisotropy AnisotropyOf(const Measurement& scattered);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_ANISOTROPY_H_
