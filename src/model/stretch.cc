#include "trilobe/model/stretch.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "trilobe/base/error.h"

namespace trilobe {

double Stretch::Factor(double theta_d, double phi_d) const {
  if (!any()) return 1;
  // theta_d = 90 degrees has no highlight, and must not make it infinite.
  constexpr double kMinCosine = 1e-4;
  const double cosine = std::max(std::cos(theta_d), kMinCosine);
  return std::hypot(std::cos(phi_d) * std::pow(cosine, along),
                    std::sin(phi_d) * std::pow(cosine, across));
}

double Stretch::ThetaH(const HalfDiffAngles& angles) const {
  if (!any()) return angles.theta_h;
  return std::min(angles.theta_h * Factor(angles.theta_d, angles.phi_d), kPi / 2);
}

void CheckStretch(const Stretch& stretch) {
  for (const double exponent : {stretch.along, stretch.across}) {
    if (exponent >= -kMaxStretch && exponent <= kMaxStretch) continue;
    std::ostringstream message;
    message << "a stretch of highlights by the exponent " << exponent << "; it must be from "
            << -kMaxStretch << " to " << kMaxStretch;
    throw Error(message.str());
  }
}

}  // namespace trilobe
