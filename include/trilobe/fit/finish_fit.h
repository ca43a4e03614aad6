#ifndef TRILOBE_FIT_FINISH_FIT_H_
#define TRILOBE_FIT_FINISH_FIT_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/prior/synthetic_prior.h"
#include "trilobe/fit/prune/model_choice.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// What is made of the model that a solver has found, before it is stored. Interrupted, it keeps to
// no budget of parameters unless it has begun to choose.
struct FinishOptions {
  // Above 0: at the end the smoothest model whose E is at most that share higher takes the place of
  // what was found (Smoothest), if it does no harm. Not of a form that max_parameters chooses.
  double smoothness = 0;
  double robust = 0;       // above 0: passes of reweighting with this delta (Reweighted)
  int max_parameters = 0;  // above 0: the form that looks best within so many (ChooseModel)
  uint64_t seed = 1;       // of the samples held out to choose it by, where there is no picture
  const SyntheticPrior* prior =
      nullptr;                    // that the objective has (CorrectOvershoot); null: no correction
  bool tie_data_edge = true;      // entries that few samples read (TieEntriesAtDataEdge)
  bool match_reflectance = true;  // where that is off, as far as it does no harm (MatchReflectance)
  AppearanceOptions appearance;
  StopCheck stop = {};
};

// A change of the model after the solver had ended.
struct FinishingStep {
  // "robust", "between_samples" (CorrectOvershoot), "data_edge" (TieEntriesAtDataEdge), "form"
  // (ChooseModel), "reflected_light" (MatchReflectance) or "smoothness" (Smoothest), in this order.
  std::string name;
  double objective_before = 0, objective_after = 0;  // E of the data
  double seconds = 0;
};

struct FinishedFit {
  Objective objective;  // for models of the spec that was chosen
  FactorModel model;    // in canonical form
  std::optional<TableLayout> layout = std::nullopt;
  std::vector<FinishingStep> steps = {};        // those that changed the model
  std::vector<ModelCandidate> candidates = {};  // empty if none was asked for
  int chosen = -1;                              // which of them
  int held_out = 0;                             // samples that they were judged by; 0: all
  // Of the step reflected_light, the error of what is reflected (Reflectance::Error).
  struct Matched {
    double error_before = 0, error_after = 0;
  };
  std::optional<Matched> matched = std::nullopt;
};

// `measured`: what pictures are made of, which match_reflectance needs; null where there is none.
FinishedFit FinishFit(const Objective& objective, const BrdfTable* measured, FactorModel model,
                      const FinishOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_FIT_H_
