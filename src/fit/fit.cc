#include "trilobe/fit/fit.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include "core/system/process.h"
#include "fit/azimuths.h"
#include "fit/choose_form.h"
#include "fit/complete_options.h"
#include "fit/finish/albedo_ripple.h"
#include "fit/finish/limit_light.h"
#include "fit/fit_option.h"
#include "fit/guess_error.h"
#include "fit/held_out.h"
#include "fit/held_out_fit.h"
#include "fit/prior_of.h"
#include "fit/samples_to_fit.h"
#include "model/appearance/node_appearance.h"
#include "model/appearance/picture_data.h"
#include "model/measurement/anisotropy.h"
#include "model/objective/canonical_form.h"
#include "model/objective/gauge.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/sampled_sphere.h"
#include "trilobe/model/measurement/measured_share.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

FitInfo InfoOf(const Measurement& measurement, const FitOptions& options,
               const Objective& objective, const SolverSummary& summary) {
  return {.solver = options.solver,
          .init = options.init,
          .weighting = options.weighting.name,
          .objective = summary.final_objective,
          .solver_objective = summary.final_objective,
          .initial_objective = summary.initial_objective,
          .stop_reason = StopReasonName(summary.stop_reason),
          .iterations = summary.iterations,
          .seconds = summary.seconds,
          .threads = objective.num_threads(),
          .source = measurement.source,
          .source_xxh128 = measurement.xxh128,
          .valid_samples = objective.samples().size(),
          .max_angle = MaxAngleDegrees(measurement),
          .program = {},
          .date = {}};
}

// The model, if nobody stopped the fit and it could choose the form that it was asked for.
std::optional<FactorModel> ModelOf(FitResult fit) {
  if (fit.interrupted || fit.finished.too_few_to_choose > 0) return std::nullopt;
  return std::move(fit.file.model);
}

// One fit, step by step.
class Fitting {
 public:
  Fitting(const Measurement& measurement, const FitOptions& options)
      : measurement_(measurement),
        options_(CompleteOptions(options)),
        table_(measurement.table && !options.select ? &*measurement.table : nullptr) {}

  FitResult Run() {
    FitResult fit = RunOnShared();
    // Those of the measurement may be gone before.
    fit.objective = fit.objective.WithOwnSamples();
    return fit;
  }

 private:
  FitResult RunOnShared() {
    std::shared_ptr<const BrdfSamples> samples = SharedSamplesToFit(measurement_, options_.select);
    ModelSpec spec = options_.start_model ? options_.start_model->spec()
                                          : SpecFor(measurement_, options_.form, samples->size());
    if (options_.choose_form) MakeReadyToChoose(samples->size(), &spec);
    const std::vector<FormSpec> nodes = options_.start_model
                                            ? std::vector<FormSpec>()
                                            : NodesToTry(measurement_, options_.form, spec);
    PriorWeight(measurement_, options_);  // its error
    if (options_.bands && measurement_.bands > 0 && measurement_.samples.spectra == nullptr) {
      throw ErrorIn(ErrorKind::kConflict, measurement_.source,
                    "--spectral fits wavelengths, and three --bands were read as r, g and b; leave "
                    "out --bands, or give four or more")
          .About("bands");
    }
    if (options_.bands) CheckBands(measurement_.source, measurement_.samples, spec);
    FitResult fit{
        .objective = Objective(std::move(samples), spec, options_.weighting, options_.num_threads)};
    if (options_.bands) WithSpectra(fit.objective, measurement_);  // its error
    fit.raw = options_.raw;
    fit.seconds.prepare = stopwatch_.Lap();
    fit.interrupted = options_.stop();
    if (fit.interrupted) return fit;
    FactorModel model = Start(fit.objective);
    fit.seconds.init = stopwatch_.Lap();
    fit.interrupted = options_.stop();
    if (fit.interrupted) return fit;
    options_.on_begin();
    if (!nodes.empty()) {
      options_.on_stage("choosing nodes");
      fit.nodes = ChooseAmong(nodes, fit.objective);
      fit.objective = Objective(fit.objective, fit.nodes->model.spec());
      // The chosen model is better than a starting point that no solver will improve.
      model = options_.stop() ? fit.nodes->model : Start(fit.objective);
      fit.seconds.nodes = stopwatch_.Lap();
    }
    Solve(&fit, &model);
    return fit;
  }

  FactorModel Start(const Objective& objective) const {
    return options_.start_model ? *options_.start_model
                                : FindInitialModel(options_.init).make(objective, options_.seed);
  }

  // Sets the forms to choose from besides the spec, which is made to keep to the budget. Isotropic
  // ones are made from the finished fit (ChooseModel).
  void MakeReadyToChoose(int num_samples, ModelSpec* spec) {
    constexpr int kOfTables = 822;  // of any size
    const int budget =
        options_.max_parameters.value_or(table_ != nullptr ? kOfTables : spec->num_parameters());
    if (!options_.select) pictured_ = PictureDataOf(measurement_);
    if (spec->anisotropic()) {
      CheckMayChooseForms(options_);
      forms_ = AnisotropicForms(
          *spec, pictured_.nodes ? pictured_.nodes->table().grid : HemisphereGrid(), budget);
      *spec = forms_.front().spec;
    } else {
      isotropic_budget_ = budget;
    }
    const bool by_picture = table_ != nullptr || (spec->anisotropic() && pictured_.nodes);
    const int least = by_picture ? 0 : LeastToHoldOut(budget);
    if (num_samples >= least || spec->num_parameters() > budget) return;
    too_few_to_choose_ = least;
    forms_.clear();
    isotropic_budget_ = 0;
  }

  NodeChoice ChooseAmong(const std::vector<FormSpec>& nodes, const Objective& data,
                         double worthwhile = NodeChoiceOptions().worthwhile) const {
    return ChooseNodes(data, nodes,
                       {.seed = options_.seed,
                        .prior = PriorWeight(measurement_, options_),
                        .grid = GridOf(measurement_),
                        .worthwhile = worthwhile,
                        .on_iteration =
                            [this](const IterationRecord& record, const FactorModel&) {
                              options_.on_progress(record);
                              return true;
                            },
                        .stop = options_.stop});
  }

  // If the default nodes leave an error that is seen, finer ones are tried. They are taken while
  // E of directions held out falls by a seventh.
  void Refine(const std::optional<SyntheticPrior>& prior, SolvedForm* form, FitResult* fit) {
    constexpr double kSeen = 0.01;  // E over a black model's
    constexpr double kWorthwhile = 6.0 / 7;
    if (options_.raw || options_.start_model || !forms_.empty() || !IsDefaultSolver()) return;
    const std::vector<FormSpec> nodes = FinerNodes(measurement_, options_.form, form->data.spec());
    if (nodes.empty() || options_.stop()) return;
    if (!(form->data.Value(form->model) > kSeen * form->data.MeasuredEnergy())) return;
    options_.on_stage("trying finer nodes");
    NodeChoice choice = ChooseAmong(nodes, form->data, kWorthwhile);
    fit->seconds.nodes += stopwatch_.Lap();
    if (options_.stop()) return;
    fit->nodes = std::move(choice);
    const ModelSpec& spec = fit->nodes->model.spec();
    if (spec == form->data.spec()) return;
    const Objective data(form->data, spec);
    options_.on_stage("fitting on finer nodes");
    SolvedForm finer = SolveForm(data, prior, Start(data), /*is_first=*/false);
    fit->seconds.solve += stopwatch_.Lap();
    if (options_.stop()) return;  // the coarser one is whole
    *form = std::move(finer);
    ReportForm(*form, fit);
  }

  void Solve(FitResult* fit, FactorModel* model) {
    const std::optional<SyntheticPrior> prior = PriorOf(measurement_, options_, fit->objective);
    options_.on_stage("fitting");
    SolvedForm form = SolveForm(fit->objective, prior, std::move(*model), /*is_first=*/true);
    fit->seconds.solve = stopwatch_.Lap();
    ReportForm(form, fit);
    // The solver's model, since the steps below may take longer than somebody who ends it waits.
    if (!options_.stop()) {
      fit->file.model = form.model;
      Canonicalize(fit->objective, &fit->file.model);
      fit->file.unobserved = UnobservedParameters(fit->objective.coverage());
      options_.on_model(*fit);
    }
    Refine(prior, &form, fit);
    if (forms_.size() > 1 && !options_.stop()) {
      options_.on_stage("choosing the form");
      Choose(prior, &form, fit);
      ReportForm(form, fit);
    }
    Finish(std::move(form.solved), prior ? &*prior : nullptr, std::move(form.model), fit);
    options_.on_model(*fit);
    fit->seconds.finish = stopwatch_.Lap();
    if (options_.bands && !options_.stop()) {
      const Objective spectra = WithSpectra(fit->objective, measurement_);
      fit->bands = FitBands(spectra, fit->model(), options_.stop);
      fit->seconds.bands = stopwatch_.Lap();
    }
    if (options_.compare) {
      options_.on_stage("comparing with the measurement");
      Compare(fit);
    }
    fit->seconds.score = stopwatch_.Lap();
    if (options_.held_out && !options_.stop()) {
      const ModelSpec& spec = fit->model().spec();
      options_.on_stage("fitting without what is held out");
      fit->held_out = FitWithoutHeldOut(measurement_, options_, spec, [&](const auto& part) {
        return ModelOf(Fitting(measurement_, part).Run());
      });
      fit->seconds.held_out = stopwatch_.Lap();
    }
    fit->interrupted = options_.stop();
  }

  void ReportForm(const SolvedForm& form, FitResult* fit) const {
    fit->objective = form.data;
    if (const BrdfSamples* const added = form.solved.added()) {
      fit->prior = {added->multiplicity.back(), added->size()};
    }
    fit->summary = form.summary;
    fit->file.fit = InfoOf(measurement_, options_, fit->objective, fit->summary);
  }

  SolvedForm SolveForm(Objective data, const std::optional<SyntheticPrior>& prior,
                       FactorModel model, bool is_first) const {
    Objective solved = JoinPrior(data, prior);
    SolverOptions solver = options_.solver_options(solved.spec());
    solver.on_iteration = [this, is_first](const IterationRecord& record,
                                           const FactorModel& current) {
      options_.on_progress(record);
      if (is_first) options_.on_iteration(record, current);
      return true;
    };
    solver.on_start = options_.on_start;
    solver.stop = options_.stop;
    SolverSummary summary = MakeSolver(options_.solver)->Solve(solved, solver, &model);
    return {std::move(data), std::move(solved), std::move(model), std::move(summary)};
  }

  // Chooses the form that looks best: in a picture or, if there is none, at samples held out; it is
  // then fitted to all.
  void Choose(const std::optional<SyntheticPrior>& prior, SolvedForm* form, FitResult* fit) const {
    const auto solve = [&](const Objective& samples, const ModelSpec& spec) {
      const Objective data(samples, spec);
      return SolveForm(data, prior, Start(data), /*is_first=*/false);
    };
    const auto choose = [&](SolvedForm first, const auto& judge) {
      const Objective samples = first.data;
      ChosenForm chosen = ChooseForm(
          forms_, std::move(first), judge,
          [&](const FormSpec& other) { return solve(samples, other.spec); }, options_.stop);
      fit->finished.candidates = std::move(chosen.candidates);
      fit->finished.chosen = chosen.chosen;
      return std::move(chosen.form);
    };
    if (pictured_.nodes) {
      *form = choose(*form, PictureJudge(*form));
      return;
    }
    const HeldOutPart held_out(form->data.samples(), options_.seed, options_.num_threads);
    fit->finished.held_out = held_out.size();
    SolvedForm first = {held_out.RemoveFrom(form->data), held_out.RemoveFrom(form->solved),
                        form->model, form->summary};
    first.model = FitToPart(first.solved, std::move(first.model), options_.stop);
    first.summary.final_objective = first.data.Value(first.model);
    const SolvedForm chosen =
        choose(std::move(first), [&](const FactorModel& model) { return held_out.Score(model); });
    if (fit->finished.chosen == 0) return;
    SolvedForm on_all = solve(form->data, chosen.data.spec());
    // One that was stopped half-way may be worse than the default.
    if (options_.stop()) {
      fit->finished.chosen = 0;
    } else {
      *form = std::move(on_all);
    }
  }

  // Goes by the first form to see where the measurement can be interpolated.
  std::function<double(const FactorModel&)> PictureJudge(const SolvedForm& first) const {
    AppearanceOptions small = Appearance();  // many are rendered
    small.size = std::max(small.size / 3, 8);
    FactorModel model = first.model;
    Canonicalize(first.data, &model);
    const auto judge =
        std::make_shared<NodeJudge>(*pictured_.nodes, MaterialOf(model).spherical, small);
    return [judge](const FactorModel& other) { return (*judge)(MaterialOf(other).spherical); };
  }

  void Finish(Objective solved, const SyntheticPrior* prior, FactorModel model,
              FitResult* fit) const {
    // One that was stopped early gains more by going on.
    const bool has_ended = HasEnded(fit->summary.stop_reason);
    FinishOptions finish{.smoothness = has_ended ? options_.smoothness : 0,
                         .robust = options_.robust,
                         .max_parameters = isotropic_budget_,
                         .seed = options_.seed,
                         .prior = options_.raw ? nullptr : prior,
                         .tie_data_edge = IsDefaultSolver() && !options_.raw,
                         .match_reflectance = options_.match_reflectance && has_ended,
                         .limit_albedo = options_.limit_albedo && !options_.raw,
                         .appearance = Appearance(),
                         .on_stage = options_.on_stage,
                         .stop = options_.stop};
    const bool has_prior = solved.has_prior();
    FinishedFit finished = FinishFit(std::move(solved), table_, std::move(model), finish);
    fit->file.model = std::move(finished.model);
    if (has_prior) {
      fit->objective = Objective(fit->objective, fit->file.model.spec());
    } else {
      fit->objective = finished.objective;
    }
    fit->finished.steps = std::move(finished.steps);
    fit->finished.matched = finished.matched;
    fit->finished.glow = finished.glow;
    if (isotropic_budget_ > 0) {
      fit->finished.candidates = std::move(finished.candidates);
      fit->finished.chosen = finished.chosen;
      fit->finished.held_out = finished.held_out;
    }
    fit->finished.too_few_to_choose = too_few_to_choose_;
    fit->file.unobserved = UnobservedParameters(fit->objective.coverage());
    fit->file.layout = std::move(finished.layout);
    const ModelSpec& spec = fit->model().spec();
    fit->stored_parameters =
        fit->file.layout.value_or(TableLayout::Full(spec)).num_parameters(spec);
    fit->score = ScoreModel(fit->objective, fit->model());
    fit->file.fit.objective = fit->score.objective;
  }

  // Steps and forms of another solver would hide what the one that was asked for has found.
  bool IsDefaultSolver() const { return options_.solver == Solvers().front().name; }

  AppearanceOptions Appearance() const {
    AppearanceOptions appearance = options_.appearance;
    appearance.num_threads = options_.num_threads;
    return appearance;
  }

  void Compare(FitResult* fit) const {
    fit->objective.ReleaseFold();  // parts of the samples may be fitted once more
    const PictureData pictured = options_.select ? PictureData() : PictureDataOf(measurement_);
    if (!pictured.empty()) {
      fit->appearance = CompareAppearance(pictured, MaterialOf(fit->model()), Appearance());
    } else {
      fit->samples_seen = SeenOfSamples(fit->objective.samples(), fit->model());
    }
    if (measurement_.anisotropic && !fit->model().spec().anisotropic()) {
      fit->left_out = AnisotropyOf(measurement_).share;
    }
    if (!measurement_.table) {
      fit->reach = ReachOf(fit->objective.samples(), fit->model(), options_.num_threads);
    }
    fit->repeats = NoiseOfRepeats(fit->objective);
    fit->measured_share = MeasuredShare(fit->objective.samples());
    if (measurement_.table && fit->appearance) {
      fit->whole = EstimateWholeSphere(fit->objective, fit->model(), fit->measured_share,
                                       fit->appearance->sphere, Appearance());
    } else if (pictured.nodes) {
      fit->whole = EstimateWholeOfNodes(*pictured.nodes, fit->model(), fit->appearance->sphere,
                                        Appearance());
    } else if (fit->samples_seen) {
      fit->whole = EstimateWholeOfSamples(
          fit->objective.samples(), fit->model(), fit->stored_parameters, fit->measured_share,
          *fit->samples_seen, [&](const BrdfSamples& part) { return FitTo(part, fit->model()); },
          Appearance());
      if (options_.stop()) fit->whole.reset();  // a half was not fitted
    }
    const AlbedoRipple ripple = RippleOf(fit->model(), options_.num_threads);
    if (ripple.share > kSeenRipple) {
      fit->ripple = {.share = ripple.share, .theta_i = ripple.theta_i};
    }
    fit->light = ComputeLobeLight(fit->objective.coverage(), fit->model(), options_.num_threads);
    if (fit->bands) {
      const FactorModel rgb = fit->bands->model.ToRgb();
      fit->bands_seen = pictured.empty()
                            ? SeenOfSamples(fit->objective.samples(), rgb)
                            : CompareAppearance(pictured, MaterialOf(rgb), Appearance()).sphere;
    }
  }

  SeenError SeenOfSamples(const BrdfSamples& samples, const FactorModel& model) const {
    return CompareSampledSphere(samples, EvaluateSamples(model, samples, options_.num_threads),
                                MaterialOf(model).spherical, measurement_.anisotropic,
                                Appearance());
  }

  // Fits a part of the samples as all were fitted, from that fit, in few steps.
  FactorModel FitTo(const BrdfSamples& part, FactorModel model) const {
    const Objective data(part, model.spec(), options_.weighting, options_.num_threads);
    const std::optional<SyntheticPrior> prior = PriorOf(measurement_, options_, data);
    model = FitToPart(JoinPrior(data, prior), std::move(model), options_.stop);
    LightLimit(data, model).Lower(TableLayout::Full(model.spec()), options_.stop, &model);
    return model;
  }

  const Measurement& measurement_;
  const FitOptions options_;
  const BrdfTable* const table_;  // as the whole of it is fitted
  PictureData pictured_;          // of choices among forms_
  std::vector<FormSpec> forms_ = {};
  int isotropic_budget_ = 0;  // FinishOptions::max_parameters
  int too_few_to_choose_ = 0;
  Stopwatch stopwatch_;
};

}  // namespace

FitResult Fit(const Measurement& measurement, const FitOptions& options) {
  CheckFitOptions(options);
  if (!ChoosesAzimuths(measurement, options)) return Fitting(measurement, options).Run();
  AzimuthChoice choice =
      ChooseAzimuths(measurement, CompleteOptions(options),
                     [](const auto& data, const auto& by) { return ModelOf(Fit(data, by)); });
  FitResult fit = choice.matter ? Fitting(measurement, options).Run()
                                : Fitting(WithoutAzimuths(measurement), options).Run();
  fit.azimuths = std::move(choice);
  return fit;
}

FitProblem ProblemFor(const Measurement& measurement, const FitOptions& options,
                      const ModelSpec& spec) {
  FitProblem problem{.data = Objective(SamplesToFit(measurement, options.select), spec,
                                       options.weighting, options.num_threads)};
  const std::optional<SyntheticPrior> prior = PriorOf(measurement, options, problem.data);
  if (prior) problem.with_prior = prior->Join(problem.data);
  return problem;
}

}  // namespace trilobe
