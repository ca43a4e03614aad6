#ifndef TRILOBE_CORE_BASE_DIRECTIONS_H_
#define TRILOBE_CORE_BASE_DIRECTIONS_H_

#include <array>
#include <cmath>

#include "trilobe/core/base/angles.h"

namespace trilobe {

// A unit vector in the local frame, normal = +z.
using Direction = std::array<double, 3>;

inline double Dot(const Direction& a, const Direction& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Half-vector and difference-vector angles [rad] (Rusinkiewicz 1998), for an isotropic material:
// theta_h, theta_d in [0, pi/2], phi_d in [0, pi) by reciprocity.
struct HalfDiffAngles {
  double theta_h = 0;
  double theta_d = 0;
  double phi_d = 0;
};

// Throws Error unless all angles are numbers, theta_h and theta_d are in [0, 90] degrees and phi_d
// in [0, 180], up to rounding.
void CheckAngles(const HalfDiffAngles& angles);

// Incident and outgoing directions.
struct DirectionPair {
  Direction wi{};
  Direction wo{};
};

// The directions with these angles. The half vector is in the xz plane (phi_h = 0).
DirectionPair ToDirections(const HalfDiffAngles& angles);

// The inverse, up to a rotation about the normal. wi and wo must not be opposite.
HalfDiffAngles ToHalfDiff(const DirectionPair& pair);

// A pair of directions as a goniometer reports it [rad]: theta from the normal, phi from x towards
// y.
struct SphericalAngles {
  double theta_i = 0;
  double phi_i = 0;
  double theta_o = 0;
  double phi_o = 0;
};
// True if all angles are finite and theta_i and theta_o are in [0, 90) degrees.
bool IsAboveSurface(const SphericalAngles& angles);
DirectionPair ToDirections(const SphericalAngles& angles);
SphericalAngles ToSphericalAngles(const DirectionPair& pair);  // phi in [-pi, pi]

// A direction in polar coordinates [rad].
struct PolarAngles {
  double theta = 0;
  double phi = 0;

  bool operator==(const PolarAngles&) const = default;
};
Direction ToDirection(const PolarAngles& angles);
PolarAngles ToPolarAngles(const Direction& w);  // w of any length; phi in [-pi, pi]
Direction TurnedAboutNormal(const Direction& w, double phi);
// The half vector of two directions above the surface. Its phi is 0 within 1e-9 of the normal.
PolarAngles HalfVector(const DirectionPair& pair);

// Computed directly from the angles:
// cos theta_{i,o} = cos theta_h cos theta_d -+ sin theta_h sin theta_d cos phi_d.
struct Cosines {
  double i = 0;
  double o = 0;
};
Cosines ToCosines(const HalfDiffAngles& angles);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_DIRECTIONS_H_
