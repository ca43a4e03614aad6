#include "fit/scene/scene_fit.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <span>
#include <utility>
#include <variant>

#include "core/files/content.h"
#include "core/system/process.h"
#include "fit/choose_azimuths.h"
#include "fit/finish/limit_light.h"
#include "fit/fit_option.h"
#include "fit/prune/thinned_objective.h"
#include "fit/prune/unmeasured_prior.h"
#include "fit/scene/cached_fits.h"
#include "fit/scene/scene_judge.h"
#include "fit/scene/scene_pruner.h"
#include "io/formats/source_option.h"
#include "model/appearance/verdict.h"
#include "model/measurement/note_symptoms.h"
#include "model/objective/gauge.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/fit/as_measurement.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/load_model.h"

namespace trilobe {
namespace {

// Share of a budget of seconds after which a fit stops. The rest is for leaving out what is free.
constexpr double kFitShare = 0.8;

// Lobes where a budget asks for less error than that of the full fit.
constexpr int kMoreLobes = 5;

PruneOptions PruneOptionsOf(const SceneMaterial& material) {
  const auto& [unit, amount] = material.budget;
  PruneOptions options;
  options.max_relative_rise = 0;
  switch (unit) {
    case SceneBudget::Unit::kRelativeRise:
      options.max_relative_rise = amount;
      break;
    case SceneBudget::Unit::kPsnrDrop:
      options.max_relative_rise = std::numeric_limits<double>::infinity();
      options.max_psnr_drop_db = amount;
      break;
    case SceneBudget::Unit::kMeanDeltaE:
    case SceneBudget::Unit::kSpherePsnr:
      options.max_relative_rise = std::numeric_limits<double>::infinity();
      options.max_error = MaxError(material.budget);
      break;
    case SceneBudget::Unit::kBytes:
      options.max_parameters = static_cast<int>(std::min(amount / sizeof(double), 1e9));
      break;
    case SceneBudget::Unit::kSeconds:
      break;
  }
  options.lobes = material.reductions.lobes;
  options.colour = material.reductions.colour;
  options.shadowing = material.reductions.shadowing;
  options.tables = material.reductions.tables;
  const bool wants_more =
      amount < 0 || unit == SceneBudget::Unit::kBytes || material.budget.of_appearance();
  options.max_lobes = options.lobes && wants_more ? kMoreLobes : 0;
  return options;
}

BrdfSamples InChannels(BrdfSamples samples, SceneChannels channels) {
  if (channels == SceneChannels::kLuminance) return LuminanceOf(std::move(samples));
  return samples;
}

SceneScore ScoreOn(const Objective& objective, const FactorModel& model) {
  const ScoreReport report = ScoreModel(objective, model);
  return {report.objective, report.psnr_db};
}

// A file, or the text of a built-in model.
Source SourceOf(const std::string& name) {
  return IsMaterial(name) ? Source(name, std::string(MaterialText(name))) : Source(name);
}

// Fits one material, of which nothing is read more than once, or without need.
class MaterialFitter {
 public:
  MaterialFitter(const SceneMaterial& material, const SceneFitSettings& settings, int num_threads)
      : material_(material),
        settings_(settings),
        num_threads_(num_threads),
        source_(SourceOf(material.source)),
        fingerprint_(source_.Fingerprint()),
        is_model_(RecogniseContent(source_.bytes()).kind == Content::Kind::kJson) {}

  // `purpose` is for the key alone: fits that are to be timed apart.
  std::optional<FullFit> Fit(const std::string& purpose) {
    const std::string key = FullFitKey(material_, settings_, fingerprint_, purpose);
    if (auto cached = CachedFullFit(settings_.cache, key)) return cached;
    std::optional<FullFit> fit = FitAnew();
    if (fit) KeepFit(*fit, key, settings_.cache);
    return fit;
  }

  std::optional<MaterialFit> FitAndPrune() {
    const std::string key = MaterialFitKey(material_, settings_, fingerprint_);
    std::optional<MaterialFit> fit = CachedMaterialFit(settings_.cache, key);
    if (!fit) {
      fit = PruneAnew();
      if (fit) KeepFit(*fit, key, settings_.cache);
    }
    if (fit) fit->name = material_.name;
    return fit;
  }

  std::vector<SceneScore> Score(std::span<const FactorModel> models) const {
    const bool grey = material_.channels == SceneChannels::kLuminance;
    const Measurement measured = Measured();
    const BrdfSamples used =
        UsedSamples(SamplesOf(measured), material_.directions, measured.anisotropic);
    const Objective objective(InChannels(used, material_.channels), models.front().spec(),
                              OptionsFor(measured).weighting, num_threads_);
    std::vector<SceneScore> scores;
    for (const FactorModel& model : models) {
      const FactorModel judged = grey ? LuminanceOf(model) : model;
      scores.push_back(ScoreOn(Objective(objective, judged.spec()), judged));
    }
    return scores;
  }

 private:
  ModelFile GivenModel() const { return ParseModel(source_.bytes(), source_.name()); }

  // Options that were given, and change nothing where the source is a model.
  std::vector<std::string> OptionsOfMeasurements() const {
    std::vector<std::string> names;
    const SourceOptions source = WithOptionsOf(material_, settings_.source);
    for (const SourceOption* const option : GivenOptions(source)) {
      if (option->name != "data_seed") names.push_back(option->name);  // which --seed sets, too
    }
    const FitOptions fit = WithOptionsOf(material_, settings_.fit);
    for (const FitOption& option : AllFitOptions()) {
      const bool is_of_model = option.name == "weighting";  // of the samples that stand for it
      if (!is_of_model && IsGiven(option.name, fit)) names.push_back(option.name);
    }
    return names;
  }

  Measurement Measured() const {
    if (is_model_) {
      // Finer than what is measured, lest nodes of D fall between.
      constexpr HemisphereGrid kNodes = {.thetas = 12, .phis = 48};
      Measurement measured =
          AsMeasurement(GivenModel().model, material_.source, num_threads_, kNodes);
      measured.xxh128 = fingerprint_;
      for (const std::string& option : OptionsOfMeasurements()) {
        measured.notes.push_back(
            "--" + option + " is for measurements, and this is a model; it changes nothing here");
      }
      return measured;
    }
    SourceOptions options = WithOptionsOf(material_, settings_.source);
    options.num_threads = num_threads_;
    // Fits and judges agree whether azimuths matter, by all samples.
    Measurement measured = source_.Read(options);
    const FitOptions fit = OptionsFor(measured);
    if (measured.table && WithOptionsOf(material_, settings_.fit).prior) {
      measured.notes.emplace_back("--prior is of scattered samples, and changes nothing here");
    }
    return WithAzimuthsChosen(std::move(measured), fit);
  }

  const Measurement& measured() {
    if (!measured_) {
      measured_ = Measured();
      if (!is_model_) NoteSymptoms(num_threads_, &*measured_);
    }
    return *measured_;
  }

  // Few directions that a scene reads, in a highlight or beside it, tell no level: that is of the
  // whole measurement.
  Weighting WeightingFor(const Measurement& measured, Weighting weighting) const {
    if (!material_.reads_places()) return weighting;
    const BrdfSamples all = InChannels(SamplesOf(measured), material_.channels);
    return ForSamples(std::move(weighting), all, num_threads_);
  }

  FitOptions OptionsFor(const Measurement& measured) const {
    FitOptions options = WithOptionsOf(material_, settings_.fit);
    options.solver_options = [this](const ModelSpec& /*spec*/) { return settings_.options; };
    options.weighting = WeightingFor(measured, std::move(options.weighting));
    if (measured.table) options.prior.reset();
    options.compare = false;
    options.limit_albedo = !material_.reads_places();
    options.num_threads = num_threads_;
    options.stop = settings_.stop;
    return options;
  }

  // The fit of what the scene uses.
  FitOptions Options() const {
    FitOptions options = OptionsFor(*measured_);
    const bool limited = !reads_all_directions();
    if (limited || material_.channels != SceneChannels::kRgb) {
      options.select = [this, limited, anisotropic = measured_->anisotropic](BrdfSamples samples) {
        if (limited) samples = UsedSamples(samples, material_.directions, anisotropic);
        return InChannels(std::move(samples), material_.channels);
      };
    }
    return options;
  }

  std::optional<FullFit> FitAnew() {
    const Stopwatch stopwatch;
    const Measurement& source = measured();
    FullFit fit;
    if (is_model_) {
      fit.file = GivenModel();
      fit.seconds = stopwatch.Seconds();
      return fit;
    }
    FitOptions options = Options();
    if (material_.budget.unit == SceneBudget::Unit::kSeconds) {
      options.solver_options = [&](const ModelSpec& /*spec*/) {
        SolverOptions solver = settings_.options;
        solver.max_seconds =
            std::min(solver.max_seconds,
                     std::max(0.0, kFitShare * material_.budget.amount - stopwatch.Seconds()));
        return solver;
      };
    }
    FitResult result = trilobe::Fit(source, options);
    if (result.interrupted) return std::nullopt;
    fit.file = std::move(result.file);
    fit.file.fit.source = material_.source;
    fit.file.fit.program = settings_.program;
    fit.file.fit.date = UtcNow();
    fit.seconds = stopwatch.Seconds();
    return fit;
  }

  static int StoredParameters(const FullFit& fit) {
    const ModelSpec& spec = fit.file.model.spec();
    return fit.file.layout ? fit.file.layout->num_parameters(spec) : spec.num_parameters();
  }

  // If a picture judges, E says only where to look next: some of the samples are enough for that.
  static FitProblem Guide(const FitProblem& problem, const FullFit& fit) {
    if (problem.with_prior || problem.data.spec().anisotropic()) return problem;
    return {.data = ThinnedObjective(problem.data, StoredParameters(fit), kFewSamples)};
  }

  bool reads_all_directions() const {
    return !material_.reductions.samples ||
           std::holds_alternative<AllDirections>(material_.directions);
  }

  // Beyond the data, which no sample holds, a pruned model stays near the full one's guess.
  FitProblem WithGuess(FitProblem problem, const FactorModel& full) const {
    if (problem.with_prior || full.spec().anisotropic() || !reads_all_directions()) return problem;
    const UnmeasuredPrior prior(problem.data, full);
    if (!prior.empty()) problem.with_prior = prior.JoinTo(problem.data);
    return problem;
  }

  AppearanceOptions Appearance() const {
    AppearanceOptions options = settings_.appearance;
    options.num_threads = num_threads_;
    return options;
  }

  std::optional<MaterialFit> PruneAnew() {
    const std::optional<FullFit> full = Fit("scene");
    if (!full || settings_.stop()) return std::nullopt;
    Stopwatch stopwatch;
    const FactorModel& model = full->file.model;
    const Measurement& source = measured();
    const FitProblem problem = ProblemFor(source, Options(), model.spec());
    const Objective& objective = problem.data;
    PruneOptions prune_options = PruneOptionsOf(material_);
    prune_options.stop = settings_.stop;
    // The source is a model, so a further lobe cannot help; what remains is the error of bins.
    if (is_model_) prune_options.max_lobes = 0;
    const bool by_appearance = material_.budget.of_appearance();
    std::optional<SceneJudge> judge;
    if (by_appearance || settings_.verdicts) judge.emplace(material_, measured(), Appearance());
    if (!model.spec().anisotropic()) prune_options.layout = full->file.layout;
    // A scene that reads few directions may do without physics in the others: a limit there costs
    // small models much of what they are in those that it reads.
    std::optional<LightLimit> light;
    if (reads_all_directions()) light.emplace(objective, model);
    const ScenePruner pruner(objective, model, light ? &*light : nullptr);
    PrunedModel pruned = by_appearance
                             ? pruner.ByAppearance(WithGuess(Guide(problem, *full), model), *judge,
                                                   material_.budget, prune_options)
                             : pruner.ByE(WithGuess(problem, model), prune_options);
    if (settings_.stop()) return std::nullopt;
    MaterialFit fit;
    fit.prune_seconds = stopwatch.Lap();
    fit.fit_seconds = full->seconds;
    fit.fit_from_cache = full->from_cache;
    fit.data_notes = measured().notes;
    fit.valid_samples = CountsOf(measured()).valid;
    fit.used_samples = objective.samples().size();
    fit.full_parameters = StoredParameters(*full);
    fit.full = ScoreOn(objective, full->file.model);
    const Objective of_pruned(objective, pruned.model.spec());
    fit.pruned = ScoreOn(of_pruned, pruned.model);
    fit.misses_budget = pruned.misses_budget;
    if (judge) {
      fit.judged_by_reads = judge->kind() == SceneJudge::Kind::kReads;
      const auto judge_to = [&](const FactorModel& judged, SceneScore* score) {
        const SeenError error = judge->Compare(judged);
        score->mean_delta_e = error.mean_delta_e;
        score->seen_psnr_db = error.psnr_db;
        return error;
      };
      judge_to(model, &fit.full);
      const SeenError error = judge_to(pruned.model, &fit.pruned);
      if (settings_.verdicts) fit.verdict = Words(VerdictOf(error));
    }
    fit.file = {.model = std::move(pruned.model),
                .unobserved = UnobservedParameters(of_pruned.coverage()),
                .fit = full->file.fit,
                .layout = std::move(pruned.layout)};
    const ModelSpec& spec = fit.file.model.spec();
    if (fit.file.layout == TableLayout::Full(spec)) fit.file.layout.reset();  // all is stored
    fit.file.fit.objective = fit.pruned.objective;
    fit.num_parameters = pruned.num_parameters;
    fit.decisions = std::move(pruned.decisions);
    return fit;
  }

  const SceneMaterial& material_;
  const SceneFitSettings& settings_;
  const int num_threads_;
  const Source source_;
  const std::string fingerprint_;
  const bool is_model_;
  std::optional<Measurement> measured_;
};

}  // namespace

std::optional<MaterialFit> FitMaterial(const SceneMaterial& material,
                                       const SceneFitSettings& settings, int num_threads) {
  return MaterialFitter(material, settings, num_threads).FitAndPrune();
}

std::vector<MaterialResult> FitScene(const Scene& scene, const SceneFitSettings& settings,
                                     int num_threads,
                                     const std::function<void(const MaterialFit&)>& on_done) {
  const int count = static_cast<int>(scene.materials.size());
  std::vector<MaterialResult> results(count);
  std::mutex mutex;
  ParallelJobs(count, num_threads, [&](int k) {
    if (settings.stop()) return;
    try {
      std::optional<MaterialFit> fit = FitMaterial(scene.materials[k], settings, 1);
      const std::lock_guard<std::mutex> lock(mutex);
      if (fit && on_done) on_done(*fit);
      results[k].fit = std::move(fit);
    } catch (const std::exception& exception) {
      results[k].error = MessageOf(exception);
    }
  });
  return results;
}

std::optional<FullFit> FitWhole(const SceneMaterial& material, const SceneFitSettings& settings,
                                int num_threads) {
  SceneMaterial whole;
  whole.name = material.name;
  whole.source = material.source;
  whole.options = material.options;
  SceneFitSettings diagnosed = settings;
  diagnosed.options.diagnose = true;
  return MaterialFitter(whole, diagnosed, num_threads)
      .Fit("alone on " + std::to_string(num_threads) + " threads");
}

std::vector<SceneScore> ScoreOnScene(std::span<const FactorModel> models,
                                     const SceneMaterial& material,
                                     const SceneFitSettings& settings, int num_threads) {
  return MaterialFitter(material, settings, num_threads).Score(models);
}

}  // namespace trilobe
