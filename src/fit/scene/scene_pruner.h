#ifndef TRILOBE_FIT_SCENE_SCENE_PRUNER_H_
#define TRILOBE_FIT_SCENE_SCENE_PRUNER_H_

#include "fit/finish/limit_light.h"
#include "fit/prune/prune_options.h"
#include "fit/scene/scene_file.h"
#include "fit/scene/scene_judge.h"
#include "trilobe/fit/fit.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Prunes a fit within a budget that a model keeps which makes no light. Keeps references to what it
// is given.
class ScenePruner {
 public:
  // `light`: null where models are not limited.
  ScenePruner(const Objective& data, const FactorModel& full, const LightLimit* light)
      : data_(data), full_(full), light_(light) {}

  // A budget in E or in parameters. Where the limit of light takes the model beyond a budget in E,
  // half of it is tried, and then the full fit is kept, to the bit.
  PrunedModel ByE(const FitProblem& problem, const PruneOptions& options) const;

  // A budget in what is seen. The search judges quickly; that the budget is kept by all that the
  // judge looks at is seen afterwards, and the search repeated with a little less where it is not.
  PrunedModel ByAppearance(const FitProblem& problem, const SceneJudge& judge,
                           const SceneBudget& budget, PruneOptions options) const;

 private:
  struct Limited {
    PrunedModel pruned;
    bool was_lowered = false;  // to the limit of light
  };
  Limited Within(const FitProblem& problem, const PruneOptions& options) const;

  const Objective& data_;
  const FactorModel& full_;
  const LightLimit* const light_;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_SCENE_PRUNER_H_
