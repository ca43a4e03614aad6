#include <memory>
#include <string>
#include <vector>

#include "solvers/joint/joint_step.h"
#include "solvers/multistart/agreement.h"
#include "solvers/multistart/smooth_starts.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// As few starts as agree, with tables that soften, on few samples; then joint steps on all.
class Continuation : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("continuation", objective, options, model);
    // A joint step on all samples gains more than an iteration of others, and costs more.
    run.summary().used.relative_decrease_tolerance *= 10;
    PhaseSeconds* const phases = &run.summary().phases;
    JointStepper stepper(objective, JointStepper::Curvature::kByProgress,
                         JointStepper::Trial::kProjected, phases);
    const FactorModel given = *model;
    FactorModel best = given;
    stepper.Restart(given);
    bool go_on = run.Start(stepper.Optimality());
    if (!go_on) return run.Finish();
    stepper.Rest();
    const std::vector<SoftenedStart> starts = SoftenStarts(
        objective, given, [&] { return !go_on || run.IsToStop(); }, phases,
        [&](const SoftenedStart& start) {
          const bool better = start.E < run.best_objective();
          if (better) best = start.model;
          go_on = run.Record(best, {.accepted = better,
                                    .may_converge = false,
                                    .objective = better ? start.E : run.best_objective()});
        });
    for (const SoftenedStart& start : starts) {
      run.summary().starts.push_back({.name = start.name, .objective = start.E});
    }
    if (!starts.empty()) run.summary().notes.push_back(Agreement(run.summary().starts));
    if (go_on) {
      stepper.Restart(best);
      RepeatJointSteps(&stepper, &run);
    }
    return run.Finish();
  }
};

}  // namespace

SolverEntry ContinuationEntry() {
  return {
      .name = "continuation",
      .description = "a few starts with stiff tables that soften, the best finished on all data",
      .reference = "docs/solvers.md",
      .make = [] { return std::make_unique<Continuation>(); }};
}

}  // namespace trilobe
