#include "io/formats/optical/zemax_angles.h"

#include <cmath>

namespace trilobe {
namespace {

double WithinATurn(double phi) {
  const double turns = phi / (2 * kPi);
  return 2 * kPi * (turns - std::floor(turns));
}

}  // namespace

// Both in the frame in which the mirror direction is (s, 0, c): towards the normal is (-c, 0, s),
// and across (0, -1, 0).
SphericalAngles ToSphericalAngles(const ZemaxAngles& at) {
  const double s = std::sin(at.incidence), c = std::cos(at.incidence);
  const double along = std::sin(at.radial) * std::cos(at.azimuth);
  const double across = std::sin(at.radial) * std::sin(at.azimuth);
  const double x = std::cos(at.radial) * s - along * c;
  const double y = -across;
  const double z = std::cos(at.radial) * c + along * s;
  return {at.incidence, WithinATurn(kPi - at.rotation), std::atan2(std::hypot(x, y), z),
          WithinATurn(std::atan2(y, x) - at.rotation)};
}

ZemaxAngles ToZemaxAngles(const DirectionPair& pair) {
  const PolarAngles light = ToPolarAngles(pair.wi);
  const double rotation = kPi - light.phi;
  const Direction wo = TurnedAboutNormal(pair.wo, rotation);
  const double s = std::sin(light.theta), c = std::cos(light.theta);
  const double along = wo[2] * s - wo[0] * c, across = -wo[1];
  return {WithinATurn(rotation), light.theta, WithinATurn(std::atan2(across, along)),
          std::atan2(std::hypot(along, across), wo[0] * s + wo[2] * c)};
}

}  // namespace trilobe
