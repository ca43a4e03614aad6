#ifndef TRILOBE_SOLVERS_JOINT_NONNEGATIVE_STEP_H_
#define TRILOBE_SOLVERS_JOINT_NONNEGATIVE_STEP_H_

#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

// Damped steps from one point x under the bounds x >= 0: the minimiser of
//   g's + s'H s / 2 + lambda |S s|^2 / 2   over   x + s >= 0,
// S a diagonal metric, by an active set: solve for the parameters that are free, hold
// those that would go below 0 at 0, and again; then free those that want to come back
// (Portugal, Judice, Vicente 1994: block principal pivoting). What is left of a change after the
// last round is projected. An object keeps its storage from one point to the next.
class NonnegativeStep {
 public:
  // `order`: in which parameters are eliminated; as they come if empty. Where those come first that
  // have products with few others, and next to these, factors are sparse (FactorCholesky).
  explicit NonnegativeStep(int num_threads = 1, std::vector<size_t> order = {})
      : num_threads_(num_threads), order_(std::move(order)) {}

  // From now on steps start from x, with this S, which is 0 for parameters that cannot move. `at`
  // must stay as it is while they are asked for.
  void MoveTo(const QuadraticModel& at, std::span<const double> metric, std::span<const double> x);

  struct Result {
    std::vector<double> x;  // the new point, >= 0
    double predicted_decrease =
        0;  // of E / 2, by the undamped model; <= 0 if there is no minimiser
  };
  // lambda > 0. The active set of one call is the start of the next.
  Result Solve(double lambda);

  // Binding parameters, to start the next point's first call from.
  const std::vector<bool>& binding() const { return binding_; }
  void SetBinding(std::vector<bool> binding) { binding_ = std::move(binding); }

 private:
  int num_threads_;
  std::vector<size_t> order_;

  // How the active set was, seen from its solution.
  enum class Outcome { kRight, kChanged, kIndefinite };

  Outcome SolveFree(double lambda, bool release);
  bool SetStep(double lambda);
  bool Factor(double lambda);
  void SolveBorder();
  std::vector<double> HTimesU(const std::function<bool(size_t)>& wanted) const;
  void ForChunks(size_t count, const std::function<void(size_t, size_t)>& work) const;

  const QuadraticModel* at_ = nullptr;
  // Of all parameters; scale, its entry of S, is 0 for one that cannot move, and so are
  // unit = 1 / scale, and g, z = scale x, the step p and u = unit p.
  std::vector<double> x_, scale_, unit_, g_, z_, p_, u_;
  std::vector<bool> binding_;
  // Of the parameters that were free at the last factorisation: which, and their scaled H + lambda.
  bool factored_ = false;
  std::vector<size_t> base_;
  std::vector<bool> in_base_;
  std::vector<double> units_, L_;
  // Those that changed sides since, the former by number in base_.
  std::vector<size_t> removed_, added_;
  // What each that did asks of the factor, from when it first did: its column in solved_.
  std::vector<int> column_of_;
  std::vector<double> solved_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_NONNEGATIVE_STEP_H_
