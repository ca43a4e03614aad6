#ifndef TRILOBE_CORE_BASE_STENCIL_H_
#define TRILOBE_CORE_BASE_STENCIL_H_

#include <array>
#include <span>

namespace trilobe {

// A table lookup as a short weighted sum: sum_k weight[k] * table[index[k]], k < size. The weights
// sum to 1.
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

  // The weight of a table entry, 0 if the stencil does not read it.
  double WeightOf(int entry) const {
    for (int k = 0; k < size; ++k) {
      if (index[k] == entry) return weight[k];
    }
    return 0;
  }
};

// Coordinates within this distance of an entry [steps between entries] snap to it, so that rounding
// does not add a neighbour to the stencil.
inline constexpr double kAtEntry = 1e-9;

// A position between two neighbours: fraction `t` in [0, 1) from the lower to the upper.
struct Between {
  int lower = 0, upper = 0;
  double t = 0;
};

// Position of an angle [rad] among `count` >= 1 entries spaced evenly around a circle from 0.
// Throws Error for other counts and angles that are not finite.
Between OnCircle(double radians, int count);

// Reads one entry with weight 1.
Stencil PointStencil(int index);

// Linear between the centres of `bins` >= 2 unit bins (centre of bin i at i + 1/2), constant beyond
// the outer centres. Within kAtEntry of a centre it reads that entry alone. `coordinate` is in [0,
// bins]. Throws Error for NaN and for fewer bins.
Stencil LinearStencil(double coordinate, int bins);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_STENCIL_H_
