#ifndef TRILOBE_MATH_ARC_COSINE_H_
#define TRILOBE_MATH_ARC_COSINE_H_

#include <algorithm>
#include <array>
#include <cmath>

namespace trilobe {

namespace arc_cosine {

// acos(1 - y) = sqrt(y) P(y) within 8e-16, P of degree 16 through the Chebyshev points of [0, 1].
// (Its error falls by 5.8 a degree, as acos(1 - y) / sqrt(y) is analytic up to y = 2.)
inline constexpr std::array<double, 17> kP = {
    1.4142135623730958,     0.11785113019737603,     0.02651650433100689,    0.007891815377212338,
    0.0026854371061009403,  0.0009883935397206505,   0.00038599939353290005, 0.0001404397437549898,
    0.00011751441832351232, -0.00012489385707342216, 0.0003279876506396007,  -0.000480840434500696,
    0.0005465152188945226,  -0.0004327733803150136,  0.00023452832501033832, -7.712465385584419e-05,
    1.2131445971917302e-05};

}  // namespace arc_cosine

// Turns four numbers y in [0, 1] into the arc cosines of 1 - y [rad]. Near 0 these are as exact as
// y is, where a cosine would say little. Relative error 1e-15, of floats 1e-6.
template <typename Real>
inline void ArcCosinesOfOneMinus(std::array<Real, 4>* numbers) {
  constexpr auto kP = [](int k) { return static_cast<Real>(arc_cosine::kP[k]); };
  // Four loops, which compile to vector instructions, in steps few of which wait for each other
  // (Estrin's scheme).
  for (Real& y : *numbers) {
    const Real y2 = y * y, y4 = y2 * y2, y8 = y4 * y4;
    const auto pair = [&](int k) { return kP(k) + kP(k + 1) * y; };
    const Real low = (pair(0) + pair(2) * y2) + (pair(4) + pair(6) * y2) * y4;
    const Real high = (pair(8) + pair(10) * y2) + (pair(12) + pair(14) * y2) * y4 + kP(16) * y8;
    y = std::sqrt(y) * (low + high * y8);
  }
}

// The sine of an angle in [0, pi] by its cosine; 0 where rounding has that beyond 1.
template <typename Real>
inline Real SineOf(Real cosine) {
  return std::sqrt(std::max(1 - cosine * cosine, Real{0}));
}

}  // namespace trilobe

#endif  // TRILOBE_MATH_ARC_COSINE_H_
