#ifndef TRILOBE_MODEL_OBJECTIVE_QUADRATIC_MODEL_H_
#define TRILOBE_MODEL_OBJECTIVE_QUADRATIC_MODEL_H_

#include <algorithm>
#include <vector>

namespace trilobe {

// Second-order expansion of  E(x) = |r(x)|^2,  r_jC = sqrt(w_jC) (rho_C(j) - rho*_jC), J = dr/dx,
// about a point x, in the order of FactorModel::parameters():
//   E(x + s) / 2 = E / 2 + g's + s'H s / 2.
// Rows and columns of unobserved entries are 0.
struct QuadraticModel {
  double objective = 0;          // E = r'r
  std::vector<double> gradient;  // g = J'r. [num_parameters]
  std::vector<double> H;         // symmetric, both triangles. [num_parameters][num_parameters]
  std::vector<double> squared_lengths;  // of the columns of J: the diagonal of J'J
};

enum class Hessian {
  kGaussNewton,  // J'J
  kNewton,       // J'J + sum w (rho - rho*) d2 rho / dx2, possibly indefinite
};

// Number of accumulators in a pass over folded samples. It does not depend on the number of
// threads, so that the order of addition is fixed. It is small for few samples, since each
// accumulator must be cleared and added to the others.
constexpr int NumAccumulators(int samples) { return std::clamp(samples / 65536, 2, 8); }

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_QUADRATIC_MODEL_H_
