#ifndef TRILOBE_MODEL_OBJECTIVE_QUADRATIC_MODEL_H_
#define TRILOBE_MODEL_OBJECTIVE_QUADRATIC_MODEL_H_

#include <algorithm>
#include <vector>

namespace trilobe {

// The least-squares problem  E(x) = |r(x)|^2,  r_jC = sqrt(w_jC) (rho_C(j) - rho*_jC), J = dr/dx,
// to second order around one point x, in the order of FactorModel::parameters():
//   E(x + s) / 2 = E / 2 + g's + s'H s / 2.
// Rows and columns of unobserved bins are 0.
struct QuadraticModel {
  double objective = 0;          // E = r'r
  std::vector<double> gradient;  // g = J'r. [num_parameters]
  std::vector<double> H;         // symmetric, both triangles. [num_parameters][num_parameters]
  std::vector<double> squared_lengths;  // of the columns of J: the diagonal of J'J
};

enum class Hessian {
  kGaussNewton,  // J'J
  kNewton,       // J'J + sum w (rho - rho*) d2 rho / dx2: all of it, perhaps indefinite
};

// How many accumulators share a pass over folded samples: as many whatever the number of threads,
// so that they always add up in the same order, and few where there are few samples, since each has
// to be cleared and added to the others.
constexpr int NumAccumulators(int samples) { return std::clamp(samples / 65536, 2, 8); }

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_QUADRATIC_MODEL_H_
