#ifndef TRILOBE_SOLVERS_JOINT_CERES_RUN_H_
#define TRILOBE_SOLVERS_JOINT_CERES_RUN_H_

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

// The scaled parameters of a model for Ceres, whose column scaling and damping contain absolute
// constants. The unit of d and s is the power of two nearest to the weighted root mean square of
// the data, that of residuals the power nearest to theirs at a black model. Bounds keep x >= 0.
class CeresParameters {
 public:
  CeresParameters(const Objective& objective, FactorModel start);

  const Objective& objective() const { return objective_; }
  double value_unit() const { return value_unit_; }        // of d and s
  double residual_unit() const { return residual_unit_; }  // E becomes E / residual_unit^2

  // The starting point in Ceres' parameters, in the order of the model's.
  FactorModel Start() const;
  // The model of such parameters. Unobserved bins keep the bits of the starting point.
  FactorModel Model(FactorModel p) const;
  // Sets 0 <= x <= kMaxParameter (or the start, if larger) for a parameter block, which must hold
  // parameters of Start().
  void SetBounds(std::span<double> block, ceres::Problem* problem) const;

 private:
  FactorModel Scaled(FactorModel model, double by) const;  // d and s times `by`

  const Objective& objective_;
  const FactorModel start_;
  const double value_unit_, residual_unit_;
};

// Ceres' options for max_iterations, trust_region, nonmonotonic and a linear solver, without those
// that depend on the problem. kAuto means kSparseNormalCholesky here. Throws Error, with Ceres'
// reason, if the linear solver does not support the trust region.
ceres::Solver::Options CeresOptions(const SolverOptions& options, LinearSolver linear_solver,
                                    int num_threads);

// The current point of Ceres, and its E if known.
struct CeresPoint {
  FactorModel model;
  std::optional<double> objective = std::nullopt;
};

// Runs Ceres' trust-region minimizer from the values of the parameter blocks, after Run::Start.
// Falls back to one thread if the system gives no more. The cost must be E up to a constant factor.
// `current` returns the model of the blocks; the run records it after each iteration of Ceres, also
// after rejected steps. Only the run's stopping test applies. If Ceres fails earlier, the reason is
// kNoDecrease, with Ceres' message in a note. Adds Ceres' times to the run's phases, and returns
// Ceres' summary.
ceres::Solver::Summary MinimizeWithCeres(ceres::Solver::Options options,
                                         const std::function<CeresPoint()>& current,
                                         ceres::Problem* problem, Run* run);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_CERES_RUN_H_
