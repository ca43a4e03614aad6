#include <optional>

#include "core/system/evaluation_count.h"
#include "solvers/joint/ceres_run.h"
#include "solvers/joint/plain_problem.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// The model as one writes it down for Ceres: every sample a residual block with derivatives by
// automatic differentiation.
class LmPlain : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("lm_plain", objective, options, model);
    const int threads = objective.num_threads();
    CeresOptions(options, options.linear_solver, threads);  // throws before all that takes time
    const CeresParameters parameters(objective, *model);
    std::optional<PlainProblem> problem;
    {
      const ScopedTimer timer = run.Time(&PhaseSeconds::preparing);
      problem.emplace(parameters);
    }
    LinearSolver& linear_solver = run.summary().used.linear_solver;
    linear_solver = problem->Choose(linear_solver);
    if (run.Start()) {
      const ceres::Solver::Summary summary = MinimizeWithCeres(
          problem->OptionsFor(run.options(), threads),
          [&] { return CeresPoint{.model = problem->Model()}; }, problem->problem(), &run);
      // Its residuals are not Objective's, which would count them.
      CountValues(summary.num_residual_evaluations);
      CountDerivatives(summary.num_jacobian_evaluations);
    }
    return run.Finish();
  }
};

}  // namespace

SolverEntry LmPlainEntry() {
  return {
      .name = "lm_plain",
      .description = "Ceres' trust region on one residual block a sample, as one would write it",
      .reference = "Ceres Solver 2.1; Marquardt 1963; Powell 1970",
      .options = {"trust_region", "nonmonotonic", "linear_solver", "inner_iterations"},
      .make = [] { return std::make_unique<LmPlain>(); }};
}

}  // namespace trilobe
