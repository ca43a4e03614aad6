#ifndef TRILOBE_MODEL_APPEARANCE_PREPARED_LIGHT_H_
#define TRILOBE_MODEL_APPEARANCE_PREPARED_LIGHT_H_

#include <algorithm>
#include <cmath>

#include "core/base/lanes.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/appearance/environment.h"

namespace trilobe {

// Precomputed values of a light for all pixels of a sphere, whose direction to the eye is the same
// (+z).
struct PreparedLight {
  Direction half;    // between light and eye
  Direction across;  // half x light: at right angles to the plane of light and eye
  double theta_d, sin_d;
};

inline PreparedLight Prepare(const Light& light) {
  const Direction& l = light.direction;
  Direction half = {l[0], l[1], l[2] + 1};
  const double length = std::max(std::hypot(half[0], half[1], half[2]), 1e-150);
  for (double& x : half) x /= length;
  const Direction across = {half[1] * l[2] - half[2] * l[1], half[2] * l[0] - half[0] * l[2],
                            half[0] * l[1] - half[1] * l[0]};
  const double sin_d = std::hypot(across[0], across[1], across[2]);
  return {half, across, std::atan2(sin_d, Dot(half, l)), sin_d};
}

// phi_d of light and eye over a surface. `on_left`: the surface is left of the plane of light and
// eye, seen from the half vector towards the light.
inline double PhiDOver(const Cosines& cosines, double sin_h, double sin_d, bool on_left) {
  // cos theta_{i,o} = cos theta_h cos theta_d -+ sin theta_h sin theta_d cos phi_d.
  const double b = 2 * sin_h * sin_d;
  const double cos_phi = b > 0 ? std::clamp((cosines.o - cosines.i) / b, -1.0, 1.0) : 1.0;
  // A phi_d below 0 becomes that of the exchanged directions, phi_d + pi.
  const double phi = AngleOfCosine(cos_phi);
  return on_left || phi == 0 ? phi : kPi - phi;
}

// The angles of light and eye over a surface with normal n.
inline HalfDiffAngles AnglesOver(const Direction& n, const PreparedLight& light,
                                 const Cosines& cosines) {
  const double cos_h = std::min(Dot(n, light.half), 1.0), sin_h = SineOf(cos_h);
  return {AngleOfCosine(cos_h), light.theta_d,
          PhiDOver(cosines, sin_h, light.sin_d, Dot(n, light.across) >= 0)};
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_PREPARED_LIGHT_H_
