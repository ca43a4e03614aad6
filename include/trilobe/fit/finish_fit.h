#ifndef TRILOBE_FIT_FINISH_FIT_H_
#define TRILOBE_FIT_FINISH_FIT_H_

#include <cstdint>
#include <functional>
#include <optional>
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
  const SyntheticPrior* prior = nullptr;  // that the objective has (CorrectOvershoot)
  bool match_reflectance = true;  // where that is off, as far as it does no harm (MatchReflectance)
  AppearanceOptions appearance;
  StopCheck stop = {};
};

struct FinishedFit {
  Objective objective;  // for models of the spec that was chosen
  FactorModel model;    // in canonical form
  std::optional<TableLayout> layout = std::nullopt;
  // Nothing where the fit did not overshoot between the samples (CorrectOvershoot).
  std::optional<CorrectedOvershoot> overshoot = std::nullopt;
  // Nothing if it was not done, or found no smoother model.
  struct Smoothed {
    double rise = 0;       // of E, as a fraction
    double stiffness = 0;  // lambda (Smoothest)
  };
  std::optional<Smoothed> smoothed = std::nullopt;
  // By how much tying entries at the edge of the data raised E, as a fraction; nothing if it was
  // not done (TieEntriesAtDataEdge). After a robust fit E, here and of candidates, is that of the
  // reweighted samples.
  std::optional<double> tied = std::nullopt;
  std::vector<ModelCandidate> candidates = {};  // empty if none was asked for
  int chosen = -1;                              // which of them
  int held_out = 0;                             // samples that they were judged by; 0: all
  // Nothing if it was not done (MatchReflectance).
  struct Matched {
    double error_before = 0, error_after = 0;  // Reflectance::Error
    double rise = 0;                           // of E, as a fraction
  };
  std::optional<Matched> matched = std::nullopt;
};

// `measured`: what pictures are made of, which match_reflectance needs; null where there is none.
FinishedFit FinishFit(const Objective& objective, const BrdfTable* measured, FactorModel model,
                      const FinishOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_FIT_H_
