#include "trilobe/solvers/joint/joint_step.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

namespace {

class Newton : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    return SolveByJointSteps("newton", JointStepper::Curvature::kNewton,
                             JointStepper::Trial::kAsItIs, objective, options, model);
  }
};

}  // namespace

SolverEntry NewtonEntry() {
  return {.name = "newton",
          .description = "damped Newton steps in all parameters at once, by an active set",
          .reference = "Nielsen 1999; Portugal, Judice, Vicente 1994; docs/solvers.md",
          .make = [] { return std::make_unique<Newton>(); }};
}

}  // namespace trilobe
