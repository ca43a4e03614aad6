#include <ceres/problem.h>

#include <optional>
#include <span>

#include "solvers/joint/ceres_run.h"
#include "solvers/joint/condensed_cost.h"
#include "solvers/joint/dogleg.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// Ceres' trust region on one residual block, into which all samples are condensed.
class Lm : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("lm", objective, options, model);
    const CeresParameters parameters(objective, *model);
    FactorModel start = parameters.Start();
    const std::span<double> p = start.parameters();
    std::optional<CondensedSums> sums;
    {
      const ScopedTimer timer = run.Time(&PhaseSeconds::preparing);
      sums.emplace(parameters, p, options.positivity == Positivity::kActiveSet,
                   &run.summary().phases);
    }
    CondensedCost cost(&*sums);
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.evaluation_callback = &*sums;
    ceres::Problem problem(problem_options);
    problem.AddResidualBlock(&cost, nullptr, p.data());
    parameters.SetBounds(p, &problem);
    if (run.Start()) {
      MinimizeWithCeres(
          CeresOptions(options, LinearSolver::kDenseNormalCholesky, objective.num_threads()),
          [&] { return sums->Point(); }, &problem, &run);
    }
    return run.Finish();
  }
};

}  // namespace

FactorModel AfterDoglegSteps(const Objective& objective, FactorModel model, int steps,
                             const StopCheck& stop, PhaseSeconds* phases) {
  SolverOptions options;
  options.trust_region = TrustRegion::kDogleg;
  options.max_iterations = steps;
  options.diagnose = false;
  options.stop = [&stop] { return stop(); };
  *phases += Lm().Solve(objective, options, &model).phases;
  return model;
}

SolverEntry LmEntry() {
  return {.name = "lm",
          .description = "Ceres' trust region on one residual block, which condenses all samples",
          .reference = "Ceres Solver 2.1, DENSE_NORMAL_CHOLESKY; docs/solvers.md",
          .options = {"positivity", "trust_region", "nonmonotonic"},
          .make = [] { return std::make_unique<Lm>(); }};
}

}  // namespace trilobe
