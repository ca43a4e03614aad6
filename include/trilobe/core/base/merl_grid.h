#ifndef TRILOBE_CORE_BASE_MERL_GRID_H_
#define TRILOBE_CORE_BASE_MERL_GRID_H_

#include <algorithm>
#include <cmath>

#include "trilobe/core/base/check.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

// The half-angle grid of the MERL database (docs/your-data.md), at any resolution. Bins of theta_h
// have equal width in sqrt(theta_h), bins of theta_d and phi_d equal width in the angle. Angles in
// radians.
struct MerlGrid {
  int theta_h = 90;
  int theta_d = 90;
  int phi_d = 180;

  int size() const { return theta_h * theta_d * phi_d; }

  // phi_d varies fastest, theta_h slowest, as in a MERL file.
  int Index(int h, int d, int p) const { return p + phi_d * (d + theta_d * h); }

  // Lower edge of theta_h bin `h`; h = theta_h gives pi/2. A fractional h is a point inside the
  // bin.
  double ThetaH(double h) const { return h / theta_h * (h / theta_h) * (kPi / 2); }
  double ThetaD(double d) const { return d / theta_d * (kPi / 2); }
  double PhiD(double p) const { return p / phi_d * kPi; }

  // The centre of a bin in index space.
  HalfDiffAngles Center(int h, int d, int p) const {
    return {ThetaH(h + 0.5), ThetaD(d + 0.5), PhiD(p + 0.5)};
  }
  HalfDiffAngles Center(int bin) const {  // throws Error if out of range
    CheckIndex(bin, size(), "the bin");
    return Center(bin / (theta_d * phi_d), bin / phi_d % theta_d, bin % phi_d);
  }

  // The measure, up to a constant factor, of the direction pairs in bin (h, d, any phi_d):
  // d omega_i d omega_o = 4 cos theta_d d omega_h d omega_d, where d theta_h ~ sqrt(theta_h).
  double SolidAngle(int h, int d) const {
    const double a = ThetaH(h + 0.5), b = ThetaD(d + 0.5);
    return std::sqrt(a) * std::sin(a) * std::sin(b) * std::cos(b);
  }

  // Angle to index space: bin `i` covers [i, i + 1).
  double ThetaHCoordinate(double angle) const { return theta_h * std::sqrt(angle / (kPi / 2)); }
  double ThetaDCoordinate(double angle) const { return theta_d * (angle / (kPi / 2)); }

  // The bin that contains these angles. Throws Error as CheckAngles does.
  int Bin(const HalfDiffAngles& a) const {
    CheckAngles(a);
    const auto clamp = [](double x, int n) { return std::clamp(static_cast<int>(x), 0, n - 1); };
    return Index(clamp(ThetaHCoordinate(a.theta_h), theta_h),
                 clamp(ThetaDCoordinate(a.theta_d), theta_d), clamp(a.phi_d / kPi * phi_d, phi_d));
  }

  bool operator==(const MerlGrid&) const = default;
};

// Throws Error unless the grid has at least one bin and their number fits in an int.
void CheckGrid(const MerlGrid& grid);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_MERL_GRID_H_
