#ifndef TRILOBE_CORE_ALGEBRA_CUBIC_H_
#define TRILOBE_CORE_ALGEBRA_CUBIC_H_

#include <array>

namespace trilobe {

// Real roots of a polynomial of degree at most 3, ascending, each once.
struct RealRoots {
  int count = 0;
  std::array<double, 3> root{};
};

// Real roots of a x^3 + b x^2 + c x + d, any finite coefficients; leading ones may vanish, also
// only against the others. A polynomial that is zero everywhere has no roots to report. A root
// outside the range of double is left out.
//
// GSL's closed form gives the first guess. It loses digits where roots are close together or far
// apart in magnitude, so each root is then polished inside its own monotone piece of the polynomial
// (between the zeros of the derivative), in extended precision. That also finds roots that the
// closed form misses.
RealRoots SolveCubic(double a, double b, double c, double d);

}  // namespace trilobe

#endif  // TRILOBE_CORE_ALGEBRA_CUBIC_H_
