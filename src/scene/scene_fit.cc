#include "trilobe/scene/scene_fit.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <span>
#include <sstream>
#include <utility>
#include <variant>

#include "trilobe/base/error.h"
#include "trilobe/base/parallel.h"
#include "trilobe/base/stopwatch.h"
#include "trilobe/base/utc_time.h"
#include "trilobe/io/file.h"
#include "trilobe/io/picture_data.h"
#include "trilobe/io/source.h"
#include "trilobe/model/gauge.h"
#include "trilobe/objective/canonical_form.h"
#include "trilobe/prune/prune_anisotropic.h"
#include "trilobe/scene/cached_fits.h"
#include "trilobe/scene/luminance.h"
#include "trilobe/solvers/guide.h"
#include "trilobe/solvers/initial_model.h"

namespace trilobe {
namespace {

// With a budget of seconds: the share of it after which a fit stops. The rest is for leaving out
// what is free.
constexpr double kFitShare = 0.8;

// Lobes where a budget asks for less error than that of the full fit.
constexpr int kMoreLobes = 5;

// What distinguishes two cached results: one line each.
class Key {
 public:
  explicit Key(const std::string& kind) { Add("result", kind); }

  template <typename T>
  void Add(const std::string& name, const T& value) {
    text_ << name << "=" << value << "\n";
  }
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_ = [] {
    std::ostringstream text;
    text.precision(17);
    return text;
  }();
};

std::string HashOf(std::span<const double> numbers) {
  return ContentHash({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()});
}

struct DirectionsText {
  std::string operator()(const AllDirections& /*all*/) const { return "all"; }
  std::string operator()(const DirectionRanges& ranges) const {
    const double bounds[] = {ranges.theta_i.min, ranges.theta_i.max, ranges.theta_o.min,
                             ranges.theta_o.max};
    return "ranges " + HashOf(bounds);
  }
  std::string operator()(const DirectionList& list) const {
    std::vector<double> angles;
    for (const HalfDiffAngles& a : list.directions) {
      angles.insert(angles.end(), {a.theta_h, a.theta_d, a.phi_d});
    }
    return "list " + HashOf(angles);
  }
  std::string operator()(const DirectionHistogram& histogram) const {
    return "histogram " + HashOf(histogram.counts);
  }
};

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
  const bool wants_more = amount < 0 || unit == SceneBudget::Unit::kBytes;
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

// One material, of which nothing is read more than once, or without need.
class MaterialFitter {
 public:
  MaterialFitter(const SceneMaterial& material, const SceneFitSettings& settings, int num_threads)
      : material_(material),
        settings_(settings),
        num_threads_(num_threads),
        bytes_(IsSynthetic(material.source) ? material.source : ReadFile(material.source)),
        bytes_hash_(ContentHash(bytes_)) {}

  // `purpose` is for the key alone: fits that are to be timed apart.
  std::optional<FullFit> Fit(const std::string& purpose) {
    const std::string key = FitKey(purpose).text();
    if (auto cached = CachedFullFit(settings_.cache, key)) return cached;
    std::optional<FullFit> fit = FitAnew();
    if (fit) KeepFit(*fit, key, settings_.cache);
    return fit;
  }

  std::optional<MaterialFit> FitAndPrune() {
    const std::string key = PruneKey();
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
    const BrdfSamples used = UsedSamples(SamplesOf(Measured()), material_.directions);
    const Objective objective(InChannels(used, material_.channels), models.front().spec(),
                              FindWeighting(settings_.weighting), num_threads_);
    std::vector<SceneScore> scores;
    for (const FactorModel& model : models) {
      const FactorModel judged = grey ? LuminanceOf(model) : model;
      scores.push_back(ScoreOn(Objective(objective, judged.spec()), judged));
    }
    return scores;
  }

 private:
  // All that the fit with nothing left out depends on.
  Key FitKey(const std::string& purpose) const {
    Key key("fit 2, " + purpose);
    key.Add("program", settings_.program);
    key.Add("build", settings_.build);
    key.Add("source", bytes_hash_);
    if (IsSynthetic(material_.source)) {
      key.Add("noise", settings_.noise);
      key.Add("synth_seed", settings_.seed);
    }
    key.Add("max_angle", settings_.max_angle_deg);
    key.Add("min_theta_d", settings_.min_theta_d_deg);
    key.Add("extrapolated", settings_.extrapolated);
    key.Add("directions", material_.reductions.samples
                              ? std::visit(DirectionsText(), material_.directions)
                              : "all");
    key.Add("luminance", material_.channels == SceneChannels::kLuminance);
    key.Add("weighting", settings_.weighting);
    key.Add("lobes", settings_.lobes);
    key.Add("init", settings_.init);
    key.Add("init_seed", settings_.seed);
    key.Add("solver", settings_.solver);
    for (const SolverOption* option : OptionsReadBy(FindSolver(settings_.solver).options)) {
      std::visit([&](const auto& value) { key.Add(option->name, value); },
                 option->get(settings_.options));
    }
    if (material_.budget.unit == SceneBudget::Unit::kSeconds) {
      key.Add("seconds", material_.budget.amount);
    }
    return key;
  }

  std::string PruneKey() const {
    Key key = FitKey("scene");
    key.Add("then", "prune 4");
    key.Add("unit", static_cast<int>(material_.budget.unit));
    key.Add("amount", material_.budget.amount);
    const SceneReductions& reductions = material_.reductions;
    key.Add("lobes", reductions.lobes);
    key.Add("colour", reductions.colour);
    key.Add("shadowing", reductions.shadowing);
    key.Add("tables", reductions.tables);
    return key.text();
  }

  Measurement Measured() const {
    const SourceOptions options = {.noise = settings_.noise,
                                   .seed = settings_.seed,
                                   .num_threads = num_threads_,
                                   .max_angle_deg = settings_.max_angle_deg,
                                   .min_theta_d_deg = settings_.min_theta_d_deg,
                                   .extrapolated = settings_.extrapolated};
    return IsSynthetic(material_.source) ? LoadMeasurement(material_.source, options)
                                         : ParseMeasurement(bytes_, material_.source, options);
  }

  // What models are judged by.
  const Objective& MeasuredObjective() {
    if (!objective_) {
      const Measurement measured = Measured();
      BrdfSamples samples = SamplesOf(measured);
      valid_samples_ = samples.size();
      max_angle_ = MaxAngleDegrees(measured);
      data_notes_ = measured.notes;
      const ModelSpec spec =
          measured.anisotropic
              ? ModelSpec::AnisotropicFor(settings_.lobes,
                                          GridOf(measured).value_or(HemisphereGrid()).phis,
                                          measured.max_theta)
              : ModelSpec::SharedFactors(settings_.lobes, samples.grid);
      if (material_.reductions.samples) samples = UsedSamples(samples, material_.directions);
      objective_.emplace(InChannels(std::move(samples), material_.channels), spec,
                         FindWeighting(settings_.weighting), num_threads_);
    }
    return *objective_;
  }

  // What they are fitted to.
  const Objective& FitObjective() {
    const Objective& measured = MeasuredObjective();
    if (measured.samples().on_grid()) return measured;
    if (!guided_) {
      guided_.emplace(WithGuide(measured, {.isotropic = !measured.spec().anisotropic(),
                                           .stop = settings_.stop}),
                      measured.spec(), measured.weighting(), num_threads_);
    }
    return *guided_;
  }

  std::optional<FullFit> FitAnew() {
    Stopwatch stopwatch;
    const Objective& objective = FitObjective();
    FullFit fit;
    FactorModel& model = fit.file.model;
    model = FindInitialModel(settings_.init).make(objective, settings_.seed);
    SolverOptions options = settings_.options;
    options.stop = settings_.stop;
    fit.seconds = stopwatch.Lap();
    if (material_.budget.unit == SceneBudget::Unit::kSeconds) {
      options.max_seconds = std::min(
          options.max_seconds, std::max(0.0, kFitShare * material_.budget.amount - fit.seconds));
    }
    const SolverSummary summary = MakeSolver(settings_.solver)->Solve(objective, options, &model);
    if (summary.stop_reason == StopReason::kInterrupted) return std::nullopt;
    const Objective& measured = MeasuredObjective();
    Canonicalize(measured, &model);
    fit.file.unobserved = UnobservedParameters(measured.coverage());
    fit.file.fit = {.solver = settings_.solver,
                    .init = settings_.init,
                    .weighting = settings_.weighting,
                    .objective = measured.Value(model),
                    .initial_objective = summary.initial_objective,
                    .stop_reason = StopReasonName(summary.stop_reason),
                    .iterations = summary.iterations,
                    .seconds = summary.seconds,
                    .threads = num_threads_,
                    .source = material_.source,
                    .valid_samples = measured.samples().size(),
                    .max_angle = max_angle_,
                    .program = settings_.program,
                    .date = UtcNow()};
    fit.seconds += stopwatch.Lap();
    return fit;
  }

  std::optional<MaterialFit> PruneAnew() {
    const std::optional<FullFit> full = Fit("scene");
    if (!full || settings_.stop()) return std::nullopt;
    const Objective& objective = MeasuredObjective();
    Stopwatch stopwatch;
    PruneOptions prune_options = PruneOptionsOf(material_);
    prune_options.stop = settings_.stop;
    const FactorModel& model = full->file.model;
    PrunedModel pruned = model.spec().anisotropic()
                             ? PruneAnisotropic(objective, FitObjective(), model, prune_options)
                             : Prune(FitObjective(), model, prune_options);
    if (settings_.stop()) return std::nullopt;
    MaterialFit fit;
    fit.prune_seconds = stopwatch.Lap();
    fit.fit_seconds = full->seconds;
    fit.fit_from_cache = full->from_cache;
    fit.data_notes = data_notes_;
    fit.valid_samples = valid_samples_;
    fit.used_samples = objective.samples().size();
    fit.full_parameters = full->file.model.spec().num_parameters();
    fit.full = ScoreOn(objective, full->file.model);
    const Objective of_pruned(objective, pruned.model.spec());
    fit.pruned = ScoreOn(of_pruned, pruned.model);
    fit.file = {.model = std::move(pruned.model),
                .unobserved = UnobservedParameters(of_pruned.coverage()),
                .fit = full->file.fit,
                .layout = std::move(pruned.layout)};
    if (fit.file.model.spec().anisotropic()) fit.file.layout.reset();  // all is stored
    fit.file.fit.objective = fit.pruned.objective;
    fit.num_parameters = pruned.num_parameters;
    fit.decisions = std::move(pruned.decisions);
    return fit;
  }

  const SceneMaterial& material_;
  const SceneFitSettings& settings_;
  const int num_threads_;
  const std::string bytes_;
  const std::string bytes_hash_;
  std::optional<Objective> objective_, guided_;
  std::vector<std::string> data_notes_;
  int valid_samples_ = 0;
  double max_angle_ = 90;  // [degrees] that the measurement reaches
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
      if (fit) on_done(*fit);
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
