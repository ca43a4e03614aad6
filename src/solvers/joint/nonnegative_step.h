#ifndef TRILOBE_SOLVERS_JOINT_NONNEGATIVE_STEP_H_
#define TRILOBE_SOLVERS_JOINT_NONNEGATIVE_STEP_H_

#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

// Damped steps from a point x under the bounds x >= 0. A step s minimises
//   g's + s'H s / 2 + lambda |S s|^2 / 2   over   x + s >= 0,
// with a diagonal metric S, by an active set: solves for the free parameters, holds those at 0 that
// would go below, repeats, and releases those with a negative gradient (block principal pivoting:
// Portugal, Judice, Vicente 1994). Violations after the last round are projected. An object keeps
// its storage between points.
class NonnegativeStep {
 public:
  // `order`: elimination order; empty: as stored. Factors are sparse (FactorCholesky) if parameters
  // with products with few others come first, next to these.
  explicit NonnegativeStep(int num_threads = 1, std::vector<size_t> order = {})
      : num_threads_(num_threads), order_(std::move(order)) {}

  // Sets the point x and the metric S, which is 0 for fixed parameters. `at` must not change until
  // the last step from this point.
  void MoveTo(const QuadraticModel& at, std::span<const double> metric, std::span<const double> x);

  struct Result {
    std::vector<double> x;  // the new point, >= 0
    double predicted_decrease =
        0;  // of E / 2, by the undamped model; <= 0 if there is no minimiser
  };
  // Computes a step; lambda > 0. Starts from the active set of the last call.
  Result Solve(double lambda);

  // Binding parameters, from which the first call at the next point can start.
  const std::vector<bool>& binding() const { return binding_; }
  void SetBinding(std::vector<bool> binding) { binding_ = std::move(binding); }

 private:
  int num_threads_;
  std::vector<size_t> order_;

  // Whether the solution confirmed the active set.
  enum class Outcome { kRight, kChanged, kIndefinite };

  Outcome SolveFree(double lambda, bool release);
  bool SetStep(double lambda);
  bool Factor(double lambda);
  void SolveBorder();
  std::vector<double> HTimesU(const std::function<bool(size_t)>& wanted) const;
  void ForChunks(size_t count, const std::function<void(size_t, size_t)>& work) const;

  const QuadraticModel* at_ = nullptr;
  // Vectors over all parameters. scale, the diagonal of S, is 0 for one that cannot move, and so
  // are unit = 1 / scale, and g, z = scale x, the step p and u = unit p.
  std::vector<double> x_, scale_, unit_, g_, z_, p_, u_;
  std::vector<bool> binding_;
  // The parameters that were free at the last factorisation, and the factor L of their scaled H +
  // lambda.
  bool factored_ = false;
  std::vector<size_t> base_;
  std::vector<bool> in_base_;
  std::vector<double> units_, L_;
  // Parameters that became held and free since, the former by number in base_.
  std::vector<size_t> removed_, added_;
  // Column of each parameter that has changed sides in solved_ (columns of U and V of SetStep),
  // computed at its first change.
  std::vector<int> column_of_;
  std::vector<double> solved_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_NONNEGATIVE_STEP_H_
