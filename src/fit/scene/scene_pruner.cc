#include "fit/scene/scene_pruner.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "fit/prune/prune.h"
#include "fit/prune/prune_anisotropic.h"
#include "trilobe/model/objective/score.h"

namespace trilobe {
namespace {

constexpr double kRounding = 1e-9;

// The full fit itself, to the bit.
PruneOptions WithoutReductions(PruneOptions options) {
  options.lobes = options.colour = options.shadowing = options.tables = false;
  options.max_relative_rise = 0;
  options.max_psnr_drop_db = std::numeric_limits<double>::infinity();
  options.max_lobes = 0;
  return options;
}

bool HasLimitOfE(const PruneOptions& options) {
  return options.max_parameters == std::numeric_limits<int>::max() &&
         options.max_relative_rise >= 0 && options.max_psnr_drop_db >= 0;
}

}  // namespace

// The full fit keeps to the limit with what it took to do so.
ScenePruner::Limited ScenePruner::Within(const FitProblem& problem,
                                         const PruneOptions& options) const {
  PrunedModel pruned = full_.spec().anisotropic()
                           ? PruneAnisotropic(problem.data, problem.solved(), full_, options)
                           : Prune(problem.data, problem.solved(), full_, options);
  if (light_ == nullptr || light_->Exceeded(pruned.model).empty()) return {std::move(pruned)};
  FactorModel limited = pruned.model;
  const Objective of_pruned(data_, pruned.model.spec());
  if (!light_->Keep(of_pruned, pruned.layout, options.stop, &limited)) return {std::move(pruned)};
  const double E = of_pruned.Value(limited);
  pruned.decisions.push_back({.what = "G lowered",
                              .parameters_before = pruned.num_parameters,
                              .parameters_after = pruned.num_parameters,
                              .E_before = pruned.E,
                              .E_after = E,
                              .taken = true,
                              .why = "it reflected more light than fell on it"});
  pruned.model = std::move(limited);
  pruned.E = E;
  return {.pruned = std::move(pruned), .was_lowered = true};
}

PrunedModel ScenePruner::ByE(const FitProblem& problem, const PruneOptions& options) const {
  Limited limited = Within(problem, options);
  const double E_full = data_.Value(full_);
  const double psnr_full = ScoreModel(data_, full_).psnr_db;
  const auto is_within = [&](const Limited& of) {
    if (!of.was_lowered) return true;
    const Objective of_model(data_, of.pruned.model.spec());
    return of.pruned.E <= (1 + options.max_relative_rise + kRounding) * E_full &&
           ScoreModel(of_model, of.pruned.model).psnr_db >=
               psnr_full - options.max_psnr_drop_db - kRounding;
  };
  if (!HasLimitOfE(options) || is_within(limited)) return std::move(limited.pruned);
  PruneOptions half = options;
  half.max_relative_rise /= 2;
  half.max_psnr_drop_db /= 2;
  limited = Within(problem, half);
  if (is_within(limited)) return std::move(limited.pruned);
  return Within(problem, WithoutReductions(options)).pruned;
}

PrunedModel ScenePruner::ByAppearance(const FitProblem& problem, const SceneJudge& judge,
                                      const SceneBudget& budget, PruneOptions options) const {
  constexpr int kTries = 4;
  constexpr double kMargin = 0.98;
  const auto error_of = [&](const SeenError& error) { return ErrorIn(budget.unit, error); };
  const double most = MaxError(budget);
  const double full_error = error_of(judge.Compare(full_));
  // An error that is beyond the budget is so to a quick look, too.
  double share = full_error > 0 ? error_of(judge.CompareQuickly(full_)) / full_error : 1;
  for (int k = 0; k < kTries; ++k) {
    options.max_error = share * most;
    options.error = [&](const FactorModel& judged) {
      const double error = error_of(judge.CompareQuickly(judged));
      // The model will be kept from making light, which takes longer to see; of an anisotropic one
      // so much longer that it is not asked for each.
      if (light_ == nullptr || judged.spec().anisotropic() || error > options.max_error) {
        return error;
      }
      FactorModel limited = judged;
      const TableLayout all = TableLayout::Full(judged.spec());
      if (!light_->Lower(all, options.stop, &limited)) return error;
      return std::max(error, error_of(judge.CompareQuickly(limited)));
    };
    PrunedModel pruned = Within(problem, options).pruned;
    const double error = error_of(judge.Compare(pruned.model));
    if (error <= most || pruned.misses_budget || options.stop()) return pruned;
    share *= kMargin * most / error;
  }
  options.error = nullptr;
  options.max_relative_rise = 0;
  return Within(problem, options).pruned;  // what is free
}

}  // namespace trilobe
