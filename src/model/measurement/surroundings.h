#ifndef TRILOBE_MODEL_MEASUREMENT_SURROUNDINGS_H_
#define TRILOBE_MODEL_MEASUREMENT_SURROUNDINGS_H_

#include <algorithm>

#include "trilobe/core/geometry/merl_grid.h"

namespace trilobe {

// What surrounds a bin of a grid: 3 x 3 x 5 bins of theta_h, theta_d and phi_d, itself among them,
// or, where these hold too few, `reach` times as many of theta_d and phi_d to each side.
inline constexpr int kFewestAround = 9;  // values that tell what surrounds one
inline constexpr int kWidestReach = 8;   // it doubles up to that

// Calls work(theta_h, theta_d) for each row of bins there.
template <typename Work>
void ForEachRowAround(const MerlGrid& grid, int h, int d, int reach, const Work& work) {
  for (int i = std::max(h - 1, 0); i <= std::min(h + 1, grid.theta_h - 1); ++i) {
    for (int j = std::max(d - reach, 0); j <= std::min(d + reach, grid.theta_d - 1); ++j) {
      work(i, j);
    }
  }
}

// Calls work(first, end) for the ranges of phi_d in a row about bin `p`; 180 degrees further on it
// begins again, each bin being there once.
template <typename Work>
void ForEachRangeAround(const MerlGrid& grid, int p, int reach, const Work& work) {
  const int phis = grid.phi_d, bins = std::min(4 * reach + 1, phis);
  const int first = p - bins / 2, end = first + bins;
  if (first < 0) work(first + phis, phis);
  work(std::max(first, 0), std::min(end, phis));
  if (end > phis) work(0, end - phis);
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_SURROUNDINGS_H_
