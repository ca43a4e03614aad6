#include <string>
#include <utility>

#include "solvers/joint/joint_step.h"
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

}  // namespace trilobe
