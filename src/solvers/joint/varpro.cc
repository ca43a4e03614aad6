#include "trilobe/solvers/joint/joint_step.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// E is quadratic in d and s, in D, and in F, each with the rest held. Variable projection (Golub
// and Pereyra 1973) looks at E as a function of the other parameters alone, with the linear ones
// always at their best. Here, as in its cheaper relatives (Ruhe and Wedin 1980), the step is that
// of all parameters together, after which the linear ones go to their best places before the step
// is judged: exactly, a block of lobes at a time, by the sums over cells that AWLS uses.
class Varpro : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    return SolveByJointSteps("varpro", JointStepper::Curvature::kByProgress,
                             JointStepper::Trial::kProjected, objective, options, model);
  }
};

}  // namespace

SolverEntry VarproEntry() {
  return {.name = "varpro",
          .description =
              "joint steps with d, s, D, F refitted after each; a relative of variable projection",
          .reference = "Golub and Pereyra 1973; Ruhe and Wedin 1980; docs/solvers.md",
          .make = [] { return std::make_unique<Varpro>(); }};
}

}  // namespace trilobe
