#ifndef TRILOBE_FIT_FINISH_FIT_H_
#define TRILOBE_FIT_FINISH_FIT_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/finish/candidate.h"
#include "trilobe/fit/finish/synthetic_prior.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Steps after the solver. If stopped before a form is chosen, the model may exceed max_parameters.
struct FinishOptions {
  // Above 0: replaces the model by the smoothest one whose E is higher by at most this fraction
  // (Smoothest), if scores hardly suffer. Not applied to a form that max_parameters chooses.
  double smoothness = 0;
  double robust = 0;       // above 0: refits with weights of this delta (Reweighted)
  int max_parameters = 0;  // above 0: chooses the best form of at most this size (ChooseModel)
  uint64_t seed = 1;       // of the held-out samples that choose the form without pictures
  const SyntheticPrior* prior =
      nullptr;                    // the objective's, for CorrectOvershoot; null: no correction
  bool tie_data_edge = true;      // TieEntriesAtDataEdge
  bool match_reflectance = true;  // MatchReflectance, if scores hardly suffer
  bool limit_albedo = true;       // no more light than falls on it (LightLimit)
  AppearanceOptions appearance;
  // Called as a step begins: "finishing: edge rings".
  std::function<void(const std::string&)> on_stage = [](const std::string&) {};
  StopCheck stop = {};
};

// A step after the solver that changed the model.
struct FinishingStep {
  // In this order: "robust", "between_samples" (CorrectOvershoot), "data_edge"
  // (TieEntriesAtDataEdge), "form" (ChooseModel), "reflected_light" (MatchReflectance),
  // "smoothness" (Smoothest), "evenness" (WithoutRings), "energy" (LightLimit), "edge_rings"
  // (WithoutEdgeRings), "retro_rim" (WithoutRetroRim).
  std::string name;
  double objective_before = 0, objective_after = 0;  // E of the data
  double seconds = 0;
};

struct FinishedFit {
  Objective objective;  // for the spec of `model`
  FactorModel model;    // in canonical form
  std::optional<TableLayout> layout = std::nullopt;
  std::vector<FinishingStep> steps = {};   // steps that changed the model
  std::vector<Candidate> candidates = {};  // empty without max_parameters
  int chosen = -1;                         // index of the chosen candidate
  int held_out = 0;                        // samples that judged them; 0: pictures did
  // Reflectance::Error before and after the step "reflected_light".
  struct Matched {
    double error_before = 0, error_after = 0;
  };
  std::optional<Matched> matched = std::nullopt;
  // The largest directional albedo and its theta_i [rad], where a stop left more than the limit.
  struct Glow {
    double albedo = 0, theta_i = 0;
  };
  std::optional<Glow> glow = std::nullopt;
};

// Applies the steps to a solver's model. `measured` is the table whose pictures judge models, or
// null; match_reflectance needs it. With a prior, and without max_parameters, the result has the
// objective of the data alone.
FinishedFit FinishFit(Objective objective, const BrdfTable* measured, FactorModel model,
                      const FinishOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_FIT_H_
