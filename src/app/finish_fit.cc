#include "trilobe/app/finish_fit.h"

#include <utility>

#include "trilobe/model/continuous_model.h"
#include "trilobe/objective/canonical_form.h"
#include "trilobe/objective/robust.h"
#include "trilobe/solvers/joint/data_edge.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// From a fit, so that few passes and steps are enough. Returns the objective of the last pass.
Objective FitRobustly(const Objective& objective, const FinishOptions& options,
                      FactorModel* model) {
  constexpr int kPasses = 2, kSteps = 10;
  SolverOptions steps;
  steps.max_iterations = kSteps;
  steps.diagnose = false;
  steps.on_iteration = [&](const IterationRecord&, const FactorModel&) { return !options.stop(); };
  Objective reweighted = objective;
  for (int pass = 0; pass < kPasses && !options.stop(); ++pass) {
    reweighted = Objective(Reweighted(objective, *model, options.robust), objective.spec(),
                           objective.weighting(), objective.num_threads());
    MakeSolver("varpro")->Solve(reweighted, steps, model);
  }
  return reweighted;
}

}  // namespace

FinishedFit FinishFit(const Objective& objective, const BrdfTable* measured, FactorModel model,
                      const FinishOptions& options) {
  // What follows fits parameters anew, and must not lose what the weights of a robust fit have won.
  const Objective of =
      options.robust > 0 ? FitRobustly(objective, options, &model) : Objective(objective);
  std::optional<double> tied;
  if (!options.stop()) {
    const double before = of.Value(model);
    if (TieEntriesAtDataEdge(of, &model, options.stop) && before > 0) {
      tied = of.Value(model) / before - 1;
    }
  }
  Canonicalize(objective, &model);
  FinishedFit fit{.objective = objective, .model = std::move(model), .tied = tied};
  if (options.max_parameters > 0 && !options.stop()) {
    const auto psnr_by = [](const SphereJudge& sphere) {
      return [sphere](const FactorModel& candidate) {
        return sphere(ContinuousModel(candidate)).psnr_db;
      };
    };
    std::function<double(const FactorModel&)> judge_beyond;
    if (!measured->unmeasured.empty()) {
      judge_beyond = psnr_by(SphereJudge::OfAllDirections(*measured, options.appearance));
    }
    ChosenModel chosen = ChooseModel(of, fit.model,
                                     {.max_parameters = options.max_parameters,
                                      .judge = psnr_by(SphereJudge(*measured, options.appearance)),
                                      .judge_beyond = judge_beyond,
                                      .stop = options.stop});
    fit.objective = Objective(objective, chosen.model.spec());
    fit.model = std::move(chosen.model);
    fit.layout = std::move(chosen.layout);
    fit.candidates = std::move(chosen.candidates);
    fit.chosen = chosen.chosen;
  }
  return fit;
}

}  // namespace trilobe
