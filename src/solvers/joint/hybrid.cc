#include <memory>

#include "solvers/awls/make_sweep.h"
#include "solvers/joint/joint_step.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// Sweeps bring E down by orders of magnitude at once and choose the basin, then crawl; Newton steps
// do what is left. The switch comes when a sweep lowers E by less than this fraction, or after this
// many.
constexpr double kLeastDecrease = 0.02;
constexpr int kMaxSweeps = 5;

class Hybrid : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("hybrid", objective, options, model);
    const std::unique_ptr<Sweep> sweep = MakeSweep(objective, &run.summary().phases);
    FactorModel current = *model;
    bool go_on = run.Start();
    for (int k = 0; k < kMaxSweeps && go_on; ++k) {
      const double before = run.best_objective();
      (*sweep)(nullptr, &current);
      go_on = run.Record(current);
      if (run.best_objective() > (1 - kLeastDecrease) * before) break;
    }
    if (go_on) {
      JointStepper stepper(objective, JointStepper::Curvature::kByProgress,
                           JointStepper::Trial::kProjected, &run.summary().phases);
      stepper.Restart(current);
      RepeatJointSteps(&stepper, &run);
    }
    return run.Finish();
  }
};

}  // namespace

SolverEntry HybridEntry() {
  return {
      .name = "hybrid",
      .description = "AWLS sweeps while they pay, then joint steps: for experiments that compare",
      .reference = "docs/solvers.md",
      .make = [] { return std::make_unique<Hybrid>(); }};
}

}  // namespace trilobe
