#ifndef TRILOBE_CORE_MATH_STENCIL_H_
#define TRILOBE_CORE_MATH_STENCIL_H_

#include <array>
#include <span>

namespace trilobe {

// A table lookup as a short weighted sum: sum_k weight[k] * table[index[k]], k < size.
// Weights add up to 1.
struct Stencil {
  static constexpr int kMaxSize = 4;
  int size = 0;
  std::array<int, kMaxSize> index{};
  std::array<double, kMaxSize> weight{};

  double operator()(std::span<const double> table) const {
    double sum = 0;
    for (int k = 0; k < size; ++k) sum += weight[k] * table[index[k]];
    return sum;
  }

  // The weight of one table entry, 0 where the stencil does not reach it.
  double WeightOf(int entry) const {
    for (int k = 0; k < size; ++k) {
      if (index[k] == entry) return weight[k];
    }
    return 0;
  }
};

// What is nearer to an entry than this, in steps from it to the next, stands at it: else rounding
// would have it read the next one, too.
inline constexpr double kAtEntry = 1e-9;

// A place between two neighbours: `t` in [0, 1) of the way from the lower to the upper.
struct Between {
  int lower = 0, upper = 0;
  double t = 0;
};

// Where an angle [rad], lies among `count` >= 1 at even steps from 0 around a circle. Throws Error
// for other counts, and for an angle that is not finite.
Between OnCircle(double radians, int count);

// The entry itself.
Stencil PointStencil(int index);

// Linear between the centres of `bins` unit bins (centre of bin i at i + 1/2), constant beyond the
// outer centres; within kAtEntry of a centre that entry alone. `coordinate` is in [0, bins], where
// bins >= 2. Throws Error where it is not a number, and for fewer bins.
Stencil LinearStencil(double coordinate, int bins);

}  // namespace trilobe

#endif  // TRILOBE_CORE_MATH_STENCIL_H_
