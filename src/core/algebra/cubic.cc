#include "core/algebra/cubic.h"

#include <gsl/gsl_poly.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace trilobe {
namespace {

// The range of long double holds any product of a few doubles, so nothing below needs scaling.
static_assert(std::numeric_limits<long double>::max_exponent >= 16384,
              "SolveCubic needs a long double wider than double");

struct Cubic {
  long double a, b, c, d;

  long double operator()(long double x) const { return ((a * x + b) * x + c) * x + d; }
  long double Slope(long double x) const { return (3 * a * x + 2 * b) * x + c; }
  // Bound on the rounding error of operator().
  long double Error(long double x) const {
    const long double y = std::abs(x);
    const long double terms = ((std::abs(a) * y + std::abs(b)) * y + std::abs(c)) * y + std::abs(d);
    return 4 * std::numeric_limits<long double>::epsilon() * terms;
  }
};

// Zeros of the derivative, ascending; none where the polynomial is monotone.
std::vector<long double> Extrema(const Cubic& p) {
  // 3a x^2 + 2b x + c, by the formula that does not cancel.
  if (p.a == 0) return p.b == 0 ? std::vector<long double>{} : std::vector{-p.c / (2 * p.b)};
  const long double discriminant = p.b * p.b - 3 * p.a * p.c;
  if (!(discriminant > 0)) return {};
  const long double q = -(p.b + std::copysign(std::sqrt(discriminant), p.b));
  std::vector<long double> x = {q / (3 * p.a), p.c / q};
  std::ranges::sort(x);
  return x;
}

// A bound on the magnitude of all roots (Fujiwara).
long double RootBound(const Cubic& p) {
  if (p.a == 0) {
    if (p.b == 0) return std::abs(p.d / p.c);
    return 2 * std::max(std::abs(p.c / p.b), std::sqrt(std::abs(p.d / p.b)));
  }
  return 2 * std::max({std::abs(p.b / p.a), std::sqrt(std::abs(p.c / p.a)),
                       std::cbrt(std::abs(p.d / p.a))});
}

// The root between lo and hi, where p changes sign once: Newton from `guess`, by bisection where
// Newton leaves the bracket or is slow.
long double Polish(const Cubic& p, long double lo, long double hi, long double guess) {
  const bool rising = p(lo) < p(hi);
  if (lo <= 0 && hi >= 0) {  // leave zero out, so that exponents can be bisected too
    if (p.d == 0) return 0;
    const long double nearest = 0.5L / RootBound({p.d, p.c, p.b, p.a});
    if ((p.d < 0) == rising) {
      lo = nearest;
    } else {
      hi = -nearest;
    }
  }
  long double x = guess > lo && guess < hi ? guess : lo + (hi - lo) / 2;
  long double last_step = hi - lo;
  for (int i = 0; i < 200; ++i) {
    const long double value = p(x);
    if (std::abs(value) <= p.Error(x) / 4) return x;
    ((value < 0) == rising ? lo : hi) = x;
    const long double step = -value / p.Slope(x);
    long double next = x + step;
    // Far from the root of a power x^n Newton's steps are x/n: no way to cross many magnitudes.
    const bool slow = std::abs(step) > std::min(last_step / 2, std::abs(x) / 4);
    if (slow || !(next > lo && next < hi)) {
      // Halve the exponents' distance where the ends differ much in magnitude, else the distance.
      next = hi / lo > 4 || lo / hi > 4
                 ? std::copysign(std::sqrt(std::abs(lo)) * std::sqrt(std::abs(hi)), lo)
                 : lo + (hi - lo) / 2;
    }
    last_step = std::abs(next - x);
    if (next == x || !(next > lo && next < hi)) return x;
    x = next;
  }
  return x;
}

// GSL's roots of the monic cubic, as guesses; none where the division overflows.
std::vector<long double> GslRoots(const Cubic& p) {
  const auto b = static_cast<double>(p.b / p.a), c = static_cast<double>(p.c / p.a),
             d = static_cast<double>(p.d / p.a);
  // Their sixth powers appear in the closed form.
  const double largest = std::max({std::abs(b), std::sqrt(std::abs(c)), std::cbrt(std::abs(d))});
  if (!(largest < 1e50)) return {};
  double x[3];
  const int count = gsl_poly_solve_cubic(b, c, d, &x[0], &x[1], &x[2]);
  return {x, x + count};
}

}  // namespace

RealRoots SolveCubic(double a, double b, double c, double d) {
  const Cubic p{a, b, c, d};
  if (a == 0 && b == 0 && c == 0) return {};

  std::vector<long double> ends = Extrema(p);
  const long double bound = 2 * RootBound(p) + std::numeric_limits<double>::denorm_min();
  ends.insert(ends.begin(), std::min(-bound, ends.empty() ? 0 : 2 * ends.front()));
  ends.push_back(std::max(bound, ends.size() == 1 ? 0 : 2 * ends.back()));

  const std::vector<long double> guesses = a == 0 ? std::vector<long double>{} : GslRoots(p);
  std::vector<long double> found;
  for (size_t piece = 0; piece + 1 < ends.size(); ++piece) {
    const long double lo = ends[piece], hi = ends[piece + 1];
    // An extremum that touches zero is a double root, and not a change of sign.
    if (piece > 0 && std::abs(p(lo)) <= p.Error(lo)) {
      found.push_back(lo);
      continue;
    }
    if (std::abs(p(hi)) <= p.Error(hi) || (p(lo) < 0) == (p(hi) < 0)) continue;
    const auto guess =
        std::ranges::find_if(guesses, [lo, hi](long double x) { return x > lo && x < hi; });
    found.push_back(Polish(p, lo, hi, guess != guesses.end() ? *guess : lo + (hi - lo) / 2));
  }

  RealRoots roots;
  std::ranges::sort(found);
  for (const long double x : found) {
    const auto rounded = static_cast<double>(x);
    const bool repeated = roots.count > 0 && roots.root[roots.count - 1] == rounded;
    if (std::isfinite(rounded) && !repeated && roots.count < 3) roots.root[roots.count++] = rounded;
  }
  return roots;
}

}  // namespace trilobe
