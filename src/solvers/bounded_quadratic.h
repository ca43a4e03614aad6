#ifndef TRILOBE_SOLVERS_BOUNDED_QUADRATIC_H_
#define TRILOBE_SOLVERS_BOUNDED_QUADRATIC_H_

#include <span>

#include "trilobe/model/model_spec.h"

namespace trilobe {

// Most unknowns that MinimizeBounded takes: d and s of all lobes, in one channel.
inline constexpr int kMaxBoundedUnknowns = 1 + kMaxLobes;

// How E changes when a few parameters x, in which it is quadratic, move by delta and all others
// stay: exactly  E(x + delta) - E(x) = delta'H delta - 2 g'delta.
//
// Puts x where that is lowest with x + delta >= 0: non-negative least squares by an active set that
// starts at x (Lawson and Hanson 1974, chapter 23; Bro and de Jong 1997). H is symmetric and
// positive semidefinite; in directions in which E is flat, x stays: delta has a penalty of 2^-30 of
// the diagonal of H. H: [x.size()][x.size()], g: [x.size()].
//
// E does not rise by more than rounding. `E` is that of the residuals that g was summed from, so
// that g_k may be off by 2 epsilon sqrt(E H_kk). In flat directions that alone promises decreases,
// and raises E instead: those of less than (4 epsilon)^2 E / 2^-30 are not believed. There, and
// where an x would pass kMaxParameter, the parameters go to their best places one by one instead
// (BestElement).
void MinimizeBounded(std::span<const double> H, std::span<const double> g, double E,
                     std::span<double> x);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_BOUNDED_QUADRATIC_H_
