#ifndef TRILOBE_CORE_BASE_LINEAR_DENSITY_H_
#define TRILOBE_CORE_BASE_LINEAR_DENSITY_H_

#include <algorithm>
#include <cmath>

namespace trilobe {

// The integral from 0 to t of the linear function that is `a` at 0 and `b` at 1.
template <typename Real>
Real LinearIntegral(Real t, Real a, Real b) {
  return t * (a + Real{0.5} * t * (b - a));
}

// The t in [0, 1] at which that integral is `value`, for a, b >= 0, by the form of the root without
// cancellation. 0 if the function vanishes.
template <typename Real>
Real InvertLinearIntegral(Real value, Real a, Real b) {
  const Real root = a + std::sqrt(std::max(a * a + 2 * value * (b - a), Real{0}));
  return root > 0 ? std::clamp(2 * value / root, Real{0}, Real{1}) : Real{0};
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_LINEAR_DENSITY_H_
