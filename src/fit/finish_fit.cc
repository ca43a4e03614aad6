#include "trilobe/fit/finish_fit.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/system/process.h"
#include "fit/finish/data_edge.h"
#include "fit/finish/edge_rings.h"
#include "fit/finish/limit_light.h"
#include "fit/finish/reflectance.h"
#include "fit/finish/retro_rim.h"
#include "fit/finish/smoothest.h"
#include "fit/finish/without_rings.h"
#include "fit/held_out.h"
#include "fit/prune/unmeasured_prior.h"
#include "model/objective/canonical_form.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

// Starts from a fit, so that few passes and steps are enough. Returns the objective of the last
// pass.
Objective FitRobustly(const Objective& objective, const FinishOptions& options,
                      FactorModel* model) {
  constexpr int kPasses = 2, kSteps = 10;
  SolverOptions steps;
  steps.max_iterations = kSteps;
  steps.diagnose = false;
  steps.stop = options.stop;
  Objective reweighted = objective;
  for (int pass = 0; pass < kPasses && !options.stop(); ++pass) {
    reweighted = Objective(Reweighted(objective, *model, options.robust), objective.spec(),
                           objective.weighting(), objective.num_threads());
    MakeSolver("varpro")->Solve(reweighted, steps, model);
  }
  return reweighted;
}

// PSNR of a model's sphere against the measurement's [dB]: over what was measured and, if some was
// not, over all directions. The measured spheres are rendered at the first use.
class SphereScores {
 public:
  SphereScores(const BrdfTable& measured, const AppearanceOptions& options)
      : table_(measured), options_(options) {}

  // Whether there are directions beyond those that were measured.
  bool has_beyond() const { return !table_.unmeasured.empty(); }

  double ScoreMeasured(const FactorModel& model) {
    if (!measured_) measured_.emplace(table_, options_);
    return (*measured_)(MaterialOf(model).angular).psnr_db;
  }
  double ScoreBeyond(const FactorModel& model) {
    if (!beyond_) beyond_.emplace(SphereJudge::OfAllDirections(table_, options_));
    return (*beyond_)(MaterialOf(model).angular).psnr_db;
  }

 private:
  const BrdfTable& table_;
  const AppearanceOptions& options_;
  std::optional<SphereJudge> measured_, beyond_;
};

// Whether one model is as good as another in all but E.
class NoHarm {
 public:
  // `may_lose`: of the sphere where it was measured [dB].
  NoHarm(const Objective& objective, const FactorModel& before, SphereScores* scores,
         double may_lose = 0.2, double may_lose_beyond = 1)
      : samples_(EvenlySpread(objective.samples(), kSamples)),
        num_threads_(objective.num_threads()),
        scores_(*scores),
        may_lose_(may_lose),
        may_lose_beyond_(may_lose_beyond),
        measured_(scores->ScoreMeasured(before)),
        beyond_(scores->has_beyond() ? scores->ScoreBeyond(before) : 0),
        log_error_(LogError(before)) {}

  bool operator()(const FactorModel& after) const {
    constexpr double kMayGrow = 0.1;
    return scores_.ScoreMeasured(after) >= measured_ - may_lose_ &&
           (!scores_.has_beyond() || scores_.ScoreBeyond(after) >= beyond_ - may_lose_beyond_) &&
           LogError(after) <= (1 + kMayGrow) * log_error_;
  }

 private:
  double LogError(const FactorModel& model) const {
    return MeanLogError(samples_, model, num_threads_);
  }

  static constexpr int kSamples = 1 << 16;  // tell the same as a million would
  const BrdfSamples samples_;
  const int num_threads_;
  SphereScores& scores_;
  const double may_lose_, may_lose_beyond_;
  double measured_, beyond_, log_error_;
};

// Matches the reflectance as far as that does no harm, if it is worth it. `solved`: the objective
// that has been minimised, for models of the fit's spec.
void MatchReflectanceOf(const Objective& solved, const StopCheck& stop, SphereScores* scores,
                        FinishedFit* fit) {
  constexpr double kPrices[] = {30, 10, 3};
  constexpr double kWorthwhile = 0.75;  // what remains of the error
  const FactorModel& model = fit->model;
  if (!ReflectanceOf(solved, model).IsOff()) return;  // and needs no prior
  const bool thinned = fit->layout && *fit->layout != TableLayout::Full(model.spec());
  const TableLayout layout = thinned ? *fit->layout : UntiedEntries(solved.coverage(), model);
  // Values that a thinned table stores beyond the data stay, as they were fitted to more than
  // these; and entries that hardly a sample reads are held by the model's values where nothing was
  // measured.
  const Objective held = thinned ? UnmeasuredPrior(solved, model).JoinTo(solved) : solved;
  std::optional<NoHarm> no_harm;
  for (const double price : kPrices) {
    std::optional<MatchedModel> matched =
        MatchReflectance(solved, held, model, layout, price, stop);
    // A lower price mends still less.
    if (!matched || matched->error_after > kWorthwhile * matched->error_before) return;
    if (thinned) {
      SetCanonicalScale(solved.coverage(), &matched->model, solved.num_threads());
    } else {
      Canonicalize(solved, &matched->model);
    }
    if (!no_harm) no_harm.emplace(fit->objective, model, scores);
    if (!(*no_harm)(matched->model)) continue;
    // Only full tables are smoothed after this.
    if (thinned && HasRings(matched->model, solved.num_threads())) continue;
    fit->matched = {.error_before = matched->error_before, .error_after = matched->error_after};
    fit->model = std::move(matched->model);
    return;
  }
}

ModelChoiceOptions ChoiceByScores(SphereScores* scores, const FinishOptions& options) {
  ModelChoiceOptions choice;
  choice.max_parameters = options.max_parameters;
  choice.stop = options.stop;
  choice.judge = [scores](const FactorModel& candidate) {
    return scores->ScoreMeasured(candidate);
  };
  if (scores->has_beyond()) {
    choice.judge_beyond = [scores](const FactorModel& candidate) {
      return scores->ScoreBeyond(candidate);
    };
  }
  return choice;
}

// Smooths tables as far as the share allows and does no harm.
void SmoothOut(const Objective& solved, const FinishOptions& options, SphereScores* scores,
               FinishedFit* fit) {
  std::optional<NoHarm> no_harm;
  const auto is_harmless = [&](const FactorModel& smooth) {
    if (scores == nullptr) return true;
    if (!no_harm) no_harm.emplace(fit->objective, fit->model, scores);
    return (*no_harm)(smooth);
  };
  std::optional<SmoothedModel> smoothest =
      Smoothest(solved, fit->model, options.smoothness, is_harmless, options.stop);
  if (!smoothest) return;
  fit->model = std::move(smoothest->model);
}

// Removes rings if the sphere hardly suffers.
void EvenOut(const Objective& solved, const StopCheck& stop, SphereScores* scores,
             FinishedFit* fit) {
  std::optional<NoHarm> no_harm;
  const auto is_harmless = [&](const FactorModel& even) {
    if (!no_harm) no_harm.emplace(fit->objective, fit->model, scores, kMayLoseForRings);
    return (*no_harm)(even);
  };
  std::optional<FactorModel> even = WithoutRings(solved, fit->model, is_harmless, stop);
  if (even) fit->model = *std::move(even);
}

// Mends what the end of the data does to a model: a better one, of those that are acceptable.
using Acceptable = std::function<bool(const FactorModel&)>;
using EdgeMend = std::function<std::optional<FactorModel>(
    const Objective& data, const TableLayout& layout, const Acceptable& acceptable)>;

// Does so if the sphere hardly suffers or, without one, E.
void MendEdge(const EdgeMend& mend, SphereScores* scores, FinishedFit* fit) {
  constexpr double kMayRise = 0.02, kMayLoseBeyond = 3;
  const Objective data(fit->objective.data(), fit->model.spec());
  std::optional<NoHarm> no_harm;
  const auto is_harmless = [&](const FactorModel& mended) {
    if (scores == nullptr) return data.Value(mended) <= (1 + kMayRise) * data.Value(fit->model);
    if (!no_harm) no_harm.emplace(data, fit->model, scores, kMayLoseForRings, kMayLoseBeyond);
    return (*no_harm)(mended);
  };
  const TableLayout layout = fit->layout.value_or(TableLayout::Full(fit->model.spec()));
  std::optional<FactorModel> mended = mend(data, layout, is_harmless);
  if (mended) fit->model = *std::move(mended);
}

// Removes rings at the end of the data.
void EvenOutEdge(const FinishOptions& options, SphereScores* scores, FinishedFit* fit) {
  const auto mend = [&](const Objective& data, const TableLayout& layout,
                        const Acceptable& acceptable) {
    std::optional<LightLimit> limit;
    if (options.limit_albedo) limit.emplace(data, fit->model);
    return WithoutEdgeRings(data, fit->model, layout, limit ? &*limit : nullptr, acceptable,
                            options.stop);
  };
  MendEdge(mend, scores, fit);
}

// Removes a bright rim under light from the eye.
void DimRetroRim(const FinishOptions& options, SphereScores* scores, FinishedFit* fit) {
  const auto mend = [&](const Objective& data, const TableLayout& layout,
                        const Acceptable& acceptable) {
    return WithoutRetroRim(data, fit->model, layout, acceptable, options.stop);
  };
  MendEdge(mend, scores, fit);
}

// One of those that follow a solver, in this order, whatever was measured: a table or samples, with
// azimuths or without, by a fit or for a scene.
struct FinishStep {
  const char* name;
  std::function<bool()> applies;
  std::function<void()> change;
};
constexpr const char* kCanonicalForm = nullptr;  // changes no value, and is not noted

std::string StageOf(std::string step) {
  std::ranges::replace(step, '_', ' ');
  return "finishing: " + step;
}

// Takes a step, and notes what it does to E of the data and how long it takes.
void Take(const FinishStep& step, FinishedFit* fit) {
  if (step.name == kCanonicalForm) {
    step.change();
    return;
  }
  const Stopwatch stopwatch;
  const Objective objective = fit->objective;
  const FactorModel before = fit->model;
  step.change();
  if (fit->model.spec() == before.spec() &&
      std::ranges::equal(fit->model.parameters(), before.parameters())) {
    return;
  }
  const double seconds = stopwatch.Seconds();
  fit->steps.push_back({.name = step.name,
                        .objective_before = objective.data().Value(before),
                        .objective_after = fit->objective.data().Value(fit->model),
                        .seconds = seconds});
}

// No more light than falls on it, or than was measured. Notes what is left where that was stopped.
void LimitLightOf(FinishedFit* fit, const StopCheck& stop) {
  Objective data(fit->objective.data(), fit->model.spec());
  const LightLimit limit(data, fit->model);
  if (!fit->layout && ReachHorizonToLimit(limit, &data, &fit->model)) {
    fit->objective = Objective(fit->objective, fit->model.spec());
  }
  const TableLayout layout = fit->layout.value_or(TableLayout::Full(fit->model.spec()));
  limit.Keep(data, layout, stop, &fit->model);
  if (!stop()) return;
  const PeakAlbedo peak = PeakLight(fit->model, data.num_threads());
  if (peak.albedo > std::ranges::max(limit.everywhere())) {
    fit->glow = {.albedo = peak.albedo, .theta_i = peak.theta_i};
  }
}

// The form that looks best or, without pictures, fits samples best that are held out. Returns the
// weighting that it was fitted with.
Weighting TakeBestForm(const Objective& solved, const FinishOptions& options, SphereScores* scores,
                       FinishedFit* fit) {
  const Objective& objective = fit->objective;
  ChosenModel chosen;
  if (scores != nullptr) {
    chosen = ChooseModel(solved, fit->model, ChoiceByScores(scores, options));
  } else {
    const HeldOutPart held_out(objective.data().samples(), options.seed, objective.num_threads());
    fit->held_out = held_out.size();
    chosen = ChooseModel(solved, held_out, fit->model, options.max_parameters, options.stop);
  }
  fit->objective = Objective(objective, chosen.model.spec());
  fit->model = std::move(chosen.model);
  if (scores != nullptr || chosen.chosen > 0) {
    // Forms were judged by some of the samples, which may leave entries unread.
    SetCanonicalScale(fit->objective.coverage(), &fit->model, fit->objective.num_threads());
    fit->layout = std::move(chosen.layout);
  }
  fit->candidates = std::move(chosen.candidates);
  fit->chosen = chosen.chosen;
  return chosen.weighting;
}

}  // namespace

FinishedFit FinishFit(Objective objective, const BrdfTable* measured, FactorModel model,
                      const FinishOptions& options) {
  // The steps below refit parameters, and must not lose what the weights of a robust fit have won.
  Objective solved = objective;
  const std::vector<double> coverage = objective.coverage();
  const bool has_prior = objective.has_prior();
  // Must precede CorrectOvershoot, which adds more to `solved`.
  if (has_prior && options.max_parameters == 0) objective = Objective(objective.data());
  FinishedFit fit{.objective = objective, .model = std::move(model)};
  std::optional<SphereScores> of_sphere;
  if (measured != nullptr) of_sphere.emplace(*measured, options.appearance);
  SphereScores* const scores = of_sphere ? &*of_sphere : nullptr;
  Weighting weighting = objective.weighting();
  const auto is_full = [&] {
    return !fit.layout || *fit.layout == TableLayout::Full(fit.model.spec());
  };
  const auto mends_edge = [&] {
    return options.smoothness > 0 && !fit.model.spec().anisotropic() && !options.stop();
  };
  const FinishStep steps[] = {
      {"robust", [&] { return options.robust > 0; },
       [&] { solved = FitRobustly(solved, options, &fit.model); }},
      {"between_samples", [&] { return options.prior != nullptr; },
       [&] { CorrectOvershoot(*options.prior, options.stop, &solved, &fit.model); }},
      {"data_edge", [&] { return options.tie_data_edge && !options.stop(); },
       [&] { TieEntriesAtDataEdge(solved, &fit.model, options.stop); }},
      {kCanonicalForm, [] { return true; },
       [&] { Canonicalize(coverage, &fit.model, LobeOrder::kByLight, objective.num_threads()); }},
      {"form", [&] { return options.max_parameters > 0 && !options.stop(); },
       [&] { weighting = TakeBestForm(solved, options, scores, &fit); }},
      // A robust fit has given up on some of the light.
      {"reflected_light",
       [&] {
         return options.match_reflectance && options.robust == 0 && scores != nullptr &&
                !fit.model.spec().anisotropic() && !options.stop();
       },
       [&] {
         const bool same = weighting.name == objective.weighting().name;
         const Objective weighed = same ? fit.objective
                                        : Objective(objective.samples(), fit.model.spec(),
                                                    weighting, objective.num_threads());
         MatchReflectanceOf(weighed, options.stop, scores, &fit);
       }},
      // Tables of a form that was chosen are thinned.
      {"smoothness",
       [&] {
         return options.smoothness > 0 && (options.max_parameters == 0 || !fit.layout) &&
                !options.stop();
       },
       [&] { SmoothOut(solved, options, scores, &fit); }},
      {"evenness",
       [&] { return options.smoothness > 0 && is_full() && scores != nullptr && !options.stop(); },
       [&] { EvenOut(solved, options.stop, scores, &fit); }},
      // By the data alone.
      {kCanonicalForm, [&] { return has_prior && !fit.layout; },
       [&] { Canonicalize(Objective(objective.data(), fit.model.spec()), &fit.model); }},
      {"energy", [&] { return options.limit_albedo && !options.stop(); },
       [&] { LimitLightOf(&fit, options.stop); }},
      {"edge_rings", mends_edge, [&] { EvenOutEdge(options, scores, &fit); }},
      {"retro_rim", mends_edge, [&] { DimRetroRim(options, scores, &fit); }},
  };
  for (const FinishStep& step : steps) {
    if (!step.applies()) continue;
    if (step.name != kCanonicalForm) options.on_stage(StageOf(step.name));
    Take(step, &fit);
  }
  return fit;
}

}  // namespace trilobe
