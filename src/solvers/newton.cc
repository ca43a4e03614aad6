#include "trilobe/solvers/joint_step.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

namespace {

class Newton : public Solver {
 public:
  SolverSummary Solve(const Objective& objective, const SolverOptions& options,
                      FactorModel* model) const override {
    Run run("newton", objective, options, model);
    JointStepper stepper(objective, JointStepper::Curvature::kNewton, JointStepper::Trial::kAsItIs,
                         &run.summary().phases);
    stepper.Restart(*model);
    run.Start(stepper.Optimality());
    RepeatJointSteps(&stepper, &run);
    return run.Finish();
  }
};

}  // namespace

SolverEntry NewtonEntry() {
  return {.name = "newton",
          .description = "damped Newton steps in all numbers at once, by an active set",
          .reference = "Nielsen 1999; Portugal, Judice, Vicente 1994; docs/solvers.md",
          .make = [] { return std::make_unique<Newton>(); }};
}

}  // namespace trilobe
