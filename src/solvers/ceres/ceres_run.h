#ifndef TRILOBE_SOLVERS_CERES_CERES_RUN_H_
#define TRILOBE_SOLVERS_CERES_CERES_RUN_H_

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <functional>
#include <optional>
#include <span>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver_options.h"

namespace trilobe {

// A model's parameters x as Ceres sees them. d and s are measured in the power of two next to the
// weighted root mean square of the data, and residuals in that next to theirs at a black model,
// since Ceres' scaling of columns and its damping contain absolute constants. x >= 0 is kept by
// bounds.
class CeresParameters {
 public:
  CeresParameters(const Objective& objective, FactorModel start);

  const Objective& objective() const { return objective_; }
  double value_unit() const { return value_unit_; }        // of d and s
  double residual_unit() const { return residual_unit_; }  // E becomes E / residual_unit^2

  // The starting point in Ceres' parameters, each in the place of the model's.
  FactorModel Start() const;
  // The model of such parameters. Unobserved bins are the starting point's, to the last bit.
  FactorModel Model(FactorModel p) const;
  // 0 <= x <= kMaxParameter, or the start if that is above, for a block of the problem that holds
  // such parameters of the starting point.
  void SetBounds(std::span<double> block, ceres::Problem* problem) const;

 private:
  FactorModel Scaled(FactorModel model, double by) const;  // d and s times `by`

  const Objective& objective_;
  const FactorModel start_;
  const double value_unit_, residual_unit_;
};

// What Ceres is told of a run with these options (max_iterations, trust_region, nonmonotonic), but
// for what depends on the problem. kAuto stands for
// kSparseNormalCholesky here. Throws Error, with Ceres' reason, where the linear solver and the
// trust region do not go together.
ceres::Solver::Options CeresOptions(const SolverOptions& options, LinearSolver linear_solver,
                                    int num_threads);

// Where Ceres stands, and E there if it is known.
struct CeresPoint {
  FactorModel model;
  std::optional<double> objective = std::nullopt;
};

// Makes the iterations of a run that Run::Start has begun by Ceres' trust-region minimizer from
// where the problem's parameter blocks stand, on this thread alone where the system gives no more.
// The problem's cost is to be E up to a constant factor. `current` makes a model of the blocks,
// which are up to date when it is called; the run records it after each iteration of Ceres, those
// among them whose step was taken back. The run's stopping test is the only one; where Ceres can go
// no further before, it is kNoDecrease, with Ceres' reason in a note. Adds Ceres' times to the
// run's phases.
void MinimizeWithCeres(ceres::Solver::Options options, const std::function<CeresPoint()>& current,
                       ceres::Problem* problem, Run* run);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_CERES_CERES_RUN_H_
