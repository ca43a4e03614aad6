#ifndef TRILOBE_SUMS_NORMAL_EQUATIONS_H_
#define TRILOBE_SUMS_NORMAL_EQUATIONS_H_

#include <algorithm>
#include <memory>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/objective/objective.h"

namespace trilobe {

// The least-squares problem  E(x) = |r(x)|^2,  r_jC = sqrt(w_jC) (rho_C(j) - rho*_jC), J = dr/dx,
// to second order around one point x, in the order of FactorModel::parameters():
//   E(x + s) / 2 = E / 2 + g's + s'H s / 2.
// Rows and columns of dead bins are 0.
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

// Into how many shares a pass over folded samples is split, each with its own sums: as many
// whatever the number of threads, so that they always add up in the same order, and few where there
// are few samples, since sums are cleared and added up for each.
constexpr int NumShares(int samples) { return std::clamp(samples / 65536, 2, 8); }

class SampleEquations;

// Accumulates it without ever storing J, in one pass over the samples (docs/method.md). Samples on
// a grid are taken folded, by their cells; others one by one (SampleEquations).
class NormalEquations {
 public:
  explicit NormalEquations(const Objective& objective);
  ~NormalEquations();

  // The same bits for any number of threads.
  void Evaluate(const FactorModel& model, Hessian hessian, QuadraticModel* result);

 private:
  class Condensed;
  const Objective& objective_;
  std::unique_ptr<Condensed> condensed_;  // null where samples are not on a grid; then:
  std::unique_ptr<SampleEquations> of_samples_;
};

// The same from each sample's own derivatives, in a time that only small data forgive: the
// reference for tests.
void EvaluateLiterally(const Objective& objective, const FactorModel& model, Hessian hessian,
                       QuadraticModel* result);

}  // namespace trilobe

#endif  // TRILOBE_SUMS_NORMAL_EQUATIONS_H_
