#include "trilobe/core/base/directions.h"

#include <algorithm>
#include <sstream>

#include "trilobe/core/base/error.h"

namespace trilobe {

Direction ToDirection(const PolarAngles& angles) {
  const auto [theta, phi] = angles;
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

Direction TurnedAboutNormal(const Direction& w, double phi) {
  const double c = std::cos(phi), s = std::sin(phi);
  return {c * w[0] - s * w[1], s * w[0] + c * w[1], w[2]};
}

PolarAngles ToPolarAngles(const Direction& w) {
  return {std::atan2(std::hypot(w[0], w[1]), w[2]), std::atan2(w[1], w[0])};
}

void CheckAngles(const HalfDiffAngles& angles) {
  constexpr double kMaxTheta = kPi / 2 + 1e-6;
  const auto [theta_h, theta_d, phi_d] = angles;
  if (theta_h >= 0 && theta_h <= kMaxTheta && theta_d >= 0 && theta_d <= kMaxTheta && phi_d >= 0 &&
      phi_d <= kPi) {
    return;
  }
  std::ostringstream message;
  message << "theta_h, theta_d, phi_d are " << theta_h << ", " << theta_d << ", " << phi_d
          << "; they must be from 0 to pi/2, pi/2 and pi";
  throw Error(ErrorKind::kRange, message.str()).About("theta_h, theta_d, phi_d");
}

DirectionPair ToDirections(const HalfDiffAngles& angles) {
  const double sin_h = std::sin(angles.theta_h), cos_h = std::cos(angles.theta_h);
  const double sin_d = std::sin(angles.theta_d), cos_d = std::cos(angles.theta_d);
  const double x = sin_d * std::cos(angles.phi_d);
  const double y = sin_d * std::sin(angles.phi_d);
  // wi is the difference vector (x, y, cos_d) turned about the y axis by theta_h, which takes the
  // normal to the half vector (sin_h, 0, cos_h); wo is its mirror image: (-x, -y, cos_d) turned.
  return {{cos_h * x + sin_h * cos_d, y, cos_h * cos_d - sin_h * x},
          {-cos_h * x + sin_h * cos_d, -y, cos_h * cos_d + sin_h * x}};
}

HalfDiffAngles ToHalfDiff(const DirectionPair& pair) {
  const auto& [wi, wo] = pair;
  Direction h{wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]};
  const double length = std::hypot(h[0], h[1], h[2]);
  for (double& x : h) x /= length;
  const double sin_h = std::hypot(h[0], h[1]);
  const double cos_phi = sin_h > 0 ? h[0] / sin_h : 1.0;
  const double sin_phi = sin_h > 0 ? h[1] / sin_h : 0.0;
  // Turn wi about the normal by -phi_h, then about the y axis by -theta_h.
  const double x = cos_phi * wi[0] + sin_phi * wi[1];
  const double y = -sin_phi * wi[0] + cos_phi * wi[1];
  const double dx = h[2] * x - sin_h * wi[2];
  const double dz = sin_h * x + h[2] * wi[2];
  double phi_d = std::atan2(y, dx);
  if (phi_d < 0) phi_d += kPi;
  if (phi_d >= kPi) phi_d -= kPi;
  return {std::atan2(sin_h, h[2]), std::atan2(std::hypot(dx, y), dz), phi_d};
}

bool IsAboveSurface(const SphericalAngles& angles) {
  const auto above = [](double theta, double phi) {
    return theta >= 0 && theta < kPi / 2 && std::isfinite(phi);
  };
  return above(angles.theta_i, angles.phi_i) && above(angles.theta_o, angles.phi_o);
}

DirectionPair ToDirections(const SphericalAngles& angles) {
  return {ToDirection({angles.theta_i, angles.phi_i}), ToDirection({angles.theta_o, angles.phi_o})};
}

SphericalAngles ToSphericalAngles(const DirectionPair& pair) {
  const PolarAngles i = ToPolarAngles(pair.wi), o = ToPolarAngles(pair.wo);
  return {i.theta, i.phi, o.theta, o.phi};
}

PolarAngles HalfVector(const DirectionPair& pair) {
  const auto& [wi, wo] = pair;
  const Direction h{wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]};
  constexpr double kAtNormal = 1e-9;
  const auto [theta, phi] = ToPolarAngles(h);
  return {theta, theta <= kAtNormal ? 0 : phi};
}

Cosines ToCosines(const HalfDiffAngles& angles) {
  const double a = std::cos(angles.theta_h) * std::cos(angles.theta_d);
  const double b = std::sin(angles.theta_h) * std::sin(angles.theta_d) * std::cos(angles.phi_d);
  return {std::min(a - b, 1.0), std::min(a + b, 1.0)};
}

}  // namespace trilobe
