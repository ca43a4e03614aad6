#include "core/algebra/element_step.h"

#include <cmath>
#include <limits>

#include "core/algebra/cubic.h"

namespace trilobe {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// The change of E at delta. A decrease counts only if it exceeds the rounding error of its own
// terms, so that distant candidates are compared by more than noise.
double SafeChange(const ElementQuartic& q, double delta) {
  const double a = std::abs(delta);
  const double terms =
      a * (std::abs(q.c1) + a * (std::abs(q.c2) + a * (std::abs(q.c3) + a * std::abs(q.c4))));
  return q(delta) + 4 * kEpsilon * terms;
}

}  // namespace

double BestElement(double x, const ElementQuartic& change) {
  double best_x = x, best_change = 0;
  const auto consider = [&](double candidate) {
    if (!(candidate <= kMaxParameter)) return;
    const double value = SafeChange(change, candidate - x);
    if (value < best_change) {  // false for NaN
      best_x = candidate;
      best_change = value;
    }
  };
  consider(0);
  if (change.c3 == 0 && change.c4 == 0) {
    const double delta = -change.c1 / (2 * change.c2);
    if (x + delta > 0) consider(x + delta);
    return best_x;
  }
  const RealRoots stationary = SolveCubic(4 * change.c4, 3 * change.c3, 2 * change.c2, change.c1);
  for (int k = 0; k < stationary.count; ++k) {
    if (x + stationary.root[k] > 0) consider(x + stationary.root[k]);
  }
  return best_x;
}

}  // namespace trilobe
