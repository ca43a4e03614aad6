#ifndef TRILOBE_SOLVERS_SUMS_GRID_NODE_LANES_H_
#define TRILOBE_SOLVERS_SUMS_GRID_NODE_LANES_H_

#include "core/base/multiversion.h"
#include "trilobe/core/math/catmull_rom.h"

namespace trilobe {

// Four polynomials in Bernstein terms, of the nodes that a spline reads in one interval, term by
// term. Aligned, as the vectors alone are only where the machine has them.
template <int kTerms>
struct alignas(sizeof(Lanes4)) OfNodes {
  Lanes4 term[kTerms] = {};
};

// The spline's weights of the four nodes.
inline OfNodes<4> WeightsOfNodes(const CatmullRom& spline, int interval) {
  const auto weights = spline.WeightPolynomials(interval);
  OfNodes<4> transposed;
  for (int k = 0; k < 4; ++k) {
    for (int a = 0; a < 4; ++a) transposed.term[k][a] = weights[a][k];
  }
  return transposed;
}

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_GRID_NODE_LANES_H_
