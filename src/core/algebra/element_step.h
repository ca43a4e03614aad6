#ifndef TRILOBE_CORE_ALGEBRA_ELEMENT_STEP_H_
#define TRILOBE_CORE_ALGEBRA_ELEMENT_STEP_H_

#include <array>

namespace trilobe {

// How E changes when one parameter x moves by delta and all others stay (paper 2.3): exactly
//   E(x + delta) - E(x) = c1 delta + c2 delta^2 + c3 delta^3 + c4 delta^4,
// a parabola (c3 = c4 = 0) for d, s, D and F, a quartic for G.
struct ElementQuartic {
  double c1 = 0, c2 = 0, c3 = 0, c4 = 0;

  // Adds a sample of weight w and residual r = rho* - rho, whose rho moves by p1 delta + p2
  // delta^2: w (r - p1 delta - p2 delta^2)^2 - w r^2.
  void AddSample(double w, double r, double p1, double p2) {
    c1 -= 2 * w * r * p1;
    c2 += w * (p1 * p1 - 2 * r * p2);
    c3 += 2 * w * p1 * p2;
    c4 += w * p2 * p2;
  }

  double operator()(double delta) const {
    return delta * (c1 + delta * (c2 + delta * (c3 + delta * c4)));
  }
};

// No parameter grows beyond this, so that no product of five of them overflows. Fits do not come
// near it; a parameter that E hardly depends on could.
inline constexpr double kMaxParameter = 1e60;

// The x' in [0, kMaxParameter] with the lowest E along the element (docs/sums.md): the best of x
// itself, 0, and the stationary points >= 0. Returns x where nothing lowers E by more than rounding
// can tell.
double BestElement(double x, const ElementQuartic& change);

}  // namespace trilobe

#endif  // TRILOBE_CORE_ALGEBRA_ELEMENT_STEP_H_
