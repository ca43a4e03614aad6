#ifndef TRILOBE_MODEL_APPEARANCE_ALBEDO_ERROR_H_
#define TRILOBE_MODEL_APPEARANCE_ALBEDO_ERROR_H_

#include <span>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/measurement/albedo.h"

namespace trilobe {

// Directional albedos over theta_i, and phi_i where azimuths matter, of what is measured alone.
struct AlbedoError {
  std::vector<double> theta_i, phi_i;  // [rad]
  std::vector<Rgb> measured, fitted;   // [theta_i.size()]
  double mean = 0, max = 0;            // of |fitted - measured|, over angles and channels
};

// At theta_i = 0, 15, ... 75 degrees for each phi_i. Both functions are 0 where nothing is
// measured.
AlbedoError CompareAlbedos(const BrdfFunction& measured, const BrdfFunction& fitted,
                           std::span<const double> phi_i, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_ALBEDO_ERROR_H_
