#ifndef TRILOBE_SOLVERS_NONNEGATIVE_STEP_H_
#define TRILOBE_SOLVERS_NONNEGATIVE_STEP_H_

#include <memory>
#include <span>
#include <vector>

#include "trilobe/solvers/normal_equations.h"

namespace trilobe {

// Damped steps from one point x under the bounds x >= 0: the minimiser of
//   g's + s'H s / 2 + lambda |S s|^2 / 2   over   x + s >= 0,
// S the lengths of the columns of J, by an active set: solve for the parameters that are free, hold
// those that would go below 0 at 0, and again; then free those that want to come back
// (Portugal, Judice, Vicente 1994: block principal pivoting). What is left of a change after the
// last round is projected.
class NonnegativeStep {
 public:
  NonnegativeStep(const QuadraticModel& at, std::span<const double> x);
  ~NonnegativeStep();

  struct Result {
    std::vector<double> x;  // the new point, >= 0
    double predicted_decrease =
        0;  // of E / 2, by the undamped model; <= 0 if there is no minimiser
  };
  // lambda > 0. The active set of one call is the start of the next.
  Result Solve(double lambda);

  // Binding parameters, to start the next point's first call from.
  const std::vector<bool>& binding() const;
  void SetBinding(std::vector<bool> binding);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_NONNEGATIVE_STEP_H_
