#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "trilobe/solvers/diagnosis.h"
#include "trilobe/solvers/nonnegative_step.h"
#include "trilobe/solvers/normal_equations.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

class Lm : public Solver {
 public:
  SolverSummary Solve(const Objective& objective, const SolverOptions& options,
                      FactorModel* model) const override {
    Run run("lm", objective, options, model);
    FactorModel current = *model;
    NormalEquations equations(objective);
    QuadraticModel at;
    double lambda = 1e-3, growth = 2;
    std::vector<bool> binding;
    {
      const ScopedTimer timer = run.Time(&PhaseSeconds::evaluating);
      equations.Evaluate(current, Hessian::kGaussNewton, &at);
    }
    bool go_on = run.Start(ScaledProjectedGradient(at, current.parameters()));
    while (go_on) {
      NonnegativeStep step(at, current.parameters());
      if (!binding.empty()) step.SetBinding(binding);
      for (;;) {
        NonnegativeStep::Result result;
        {
          const ScopedTimer timer = run.Time(&PhaseSeconds::linear_algebra);
          result = step.Solve(lambda);
        }
        FactorModel trial = current;
        std::ranges::copy(result.x, trial.parameters().begin());
        double E;
        {
          const ScopedTimer timer = run.Time(&PhaseSeconds::evaluating);
          E = objective.Value(trial);
        }
        const double gain = (at.objective - E) / (2 * result.predicted_decrease);
        VLOG(1) << "lambda " << lambda << " E " << E << " gain " << gain << " fact "
                << result.factorizations;
        if (E < at.objective && gain > 1e-4) {
          const double f = 2 * gain - 1;
          lambda = std::max(1e-12, lambda * std::max(1.0 / 5, 1 - f * f * f));
          growth = 2;
          current = trial;
          break;
        }
        lambda *= growth;
        growth *= 2;
        if (!(lambda < 1e16)) {
          run.Stop(StopReason::kNoDecrease);
          break;
        }
        if (!run.Record(current, {.accepted = false, .objective = at.objective})) break;
      }
      if (run.stopped()) break;
      binding = step.binding();
      const double E = objective.Value(current);
      {
        const ScopedTimer timer = run.Time(&PhaseSeconds::evaluating);
        equations.Evaluate(current, Hessian::kGaussNewton, &at);
      }
      go_on = run.Record(current, {.optimality = ScaledProjectedGradient(at, current.parameters()),
                                   .objective = E});
    }
    return run.Finish();
  }
};

}  // namespace

SolverEntry LmEntry() {
  return {.name = "lm",
          .description = "Levenberg-Marquardt on all parameters at once",
          .reference = "x",
          .options = {"positivity", "trust_region"},
          .make = [] { return std::make_unique<Lm>(); }};
}

}  // namespace trilobe
