#ifndef TRILOBE_CORE_ALGEBRA_NONNEGATIVE_LEAST_SQUARES_H_
#define TRILOBE_CORE_ALGEBRA_NONNEGATIVE_LEAST_SQUARES_H_

#include <array>
#include <cstddef>
#include <span>

#include "core/algebra/element_step.h"

namespace trilobe {

// Most unknowns that SolveNonnegativeLeastSquares takes: enough for d and s of all lobes, in one
// channel.
inline constexpr int kMaxNonnegativeUnknowns = 9;

// How E changes when a few parameters x, in which it is quadratic, move by delta and all others are
// fixed: exactly  E(x + delta) - E(x) = delta'H delta - 2 g'delta.
//
// Moves x to the minimum subject to x + delta >= 0: non-negative least squares by an active set
// that starts at x (Lawson and Hanson 1974, chapter 23; Bro and de Jong 1997). H is symmetric and
// positive semidefinite; a penalty on delta of 2^-30 of the diagonal of H keeps x in place in flat
// directions. H: [x.size()][x.size()], g: [x.size()].
//
// E does not rise by more than rounding. `E` is the value of the residuals from which g was summed,
// so g_k has an error of up to 2 epsilon sqrt(E H_kk). In flat directions this error can predict
// decreases although E rises; predictions below (4 epsilon)^2 E / 2^-30 are therefore rejected.
// Then, and if an x would exceed kMaxParameter, the parameters are minimised one by one instead
// (BestElement).
void SolveNonnegativeLeastSquares(std::span<const double> H, std::span<const double> g, double E,
                                  std::span<double> x);

// The same for elements anywhere in memory; a single one uses BestElement. Moves them and returns
// their steps. False if none moved. H, g, E as above. steps: [elements.size()].
inline bool MoveToMinimum(std::span<const double> H, std::span<const double> g, double E,
                          std::span<double* const> elements, double* steps) {
  const size_t size = elements.size();
  std::array<double, kMaxNonnegativeUnknowns> x;
  for (size_t k = 0; k < size; ++k) x[k] = *elements[k];
  if (size == 1) {
    x[0] = BestElement(x[0], {.c1 = -2 * g[0], .c2 = H[0]});
  } else {
    SolveNonnegativeLeastSquares(H, g, E, {x.data(), size});
  }
  bool any = false;
  for (size_t k = 0; k < size; ++k) {
    steps[k] = x[k] - *elements[k];
    *elements[k] = x[k];
    any |= steps[k] != 0;
  }
  return any;
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_ALGEBRA_NONNEGATIVE_LEAST_SQUARES_H_
