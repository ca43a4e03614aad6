#include <memory>
#include <string>
#include <utility>

#include "solvers/joint/joint_step.h"
#include "solvers/sweep.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// Makes nothing but joint steps, from its starting point on.
class JointSolver : public Solver {
 public:
  JointSolver(std::string name, JointStepper::Curvature curvature, JointStepper::Trial trial)
      : name_(std::move(name)), curvature_(curvature), trial_(trial) {}

 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run(name_, objective, options, model);
    JointStepper stepper(objective, curvature_, trial_, &run.summary().phases);
    stepper.Restart(*model);
    run.Start(stepper.Optimality());
    RepeatJointSteps(&stepper, &run);
    return run.Finish();
  }

  const std::string name_;
  const JointStepper::Curvature curvature_;
  const JointStepper::Trial trial_;
};

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

SolverEntry NewtonEntry() {
  return {.name = "newton",
          .description =
              "damped Newton steps in all parameters, none refitted: for experiments that compare",
          .reference = "Nielsen 1999; Portugal, Judice, Vicente 1994; docs/solvers.md",
          .make = [] {
            return std::make_unique<JointSolver>("newton", JointStepper::Curvature::kNewton,
                                                 JointStepper::Trial::kAsItIs);
          }};
}

// E is quadratic in d and s, in D, and in F, each with the rest held. Variable projection (Golub
// and Pereyra 1973) looks at E as a function of the other parameters alone, with the linear ones
// always at their best. Here, as in its cheaper relatives (Ruhe and Wedin 1980), the step is that
// of all parameters together, after which the linear ones go to their best places before the step
// is judged: exactly, a block of lobes at a time, by the sums over cells that AWLS uses.
SolverEntry VarproEntry() {
  return {.name = "varpro",
          .description =
              "joint steps with d, s, D, F refitted after each; a relative of variable "
              "projection",
          .reference = "Golub and Pereyra 1973; Ruhe and Wedin 1980; docs/solvers.md",
          .make = [] {
            return std::make_unique<JointSolver>("varpro", JointStepper::Curvature::kByProgress,
                                                 JointStepper::Trial::kProjected);
          }};
}

SolverEntry HybridEntry() {
  return {
      .name = "hybrid",
      .description = "AWLS sweeps while they pay, then joint steps: for experiments that compare",
      .reference = "docs/solvers.md",
      .make = [] { return std::make_unique<Hybrid>(); }};
}

}  // namespace trilobe
