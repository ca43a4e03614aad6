#include "fit/scene/cached_fits.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>
#include <variant>
#include <vector>

#include "core/system/content_hash.h"
#include "fit/fit_option.h"
#include "io/formats/source_option.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/read_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

// Properties that distinguish two cached results: one line each.
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

Key KeyOfFullFit(const SceneMaterial& material, const SceneFitSettings& settings,
                 const std::string& source_hash, const std::string& purpose) {
  Key key("fit 5, " + purpose);
  key.Add("program", settings.program);
  key.Add("build", settings.build);
  key.Add("source", source_hash);
  const SourceOptions source = WithOptionsOf(material, settings.source);
  for (const SourceOption& option : AllSourceOptions()) key.Add(option.name, option.get(source));
  key.Add("directions",
          material.reductions.samples ? std::visit(DirectionsText(), material.directions) : "all");
  key.Add("luminance", material.channels == SceneChannels::kLuminance);
  const FitOptions fit = WithOptionsOf(material, settings.fit);
  for (const FitOption& option : AllFitOptions()) key.Add(option.name, option.get(fit));
  key.Add("init_seed", fit.seed);
  for (const SolverOption* option : OptionsReadBy(FindSolver(fit.solver).options)) {
    std::visit([&](const auto& value) { key.Add(option->name, value); },
               option->get(settings.options));
  }
  if (material.budget.unit == SceneBudget::Unit::kSeconds) {
    key.Add("seconds", material.budget.amount);
  }
  return key;
}

using Json = nlohmann::ordered_json;

Json Encode(const FullFit& fit) {
  return {{"model", FormatModel(fit.file)}, {"seconds", fit.seconds}};
}

FullFit DecodeFullFit(const Json& json) {
  return {ParseModel(json.at("model").get<std::string>(), "cache"), json.at("seconds"), true};
}

// JSON has no infinite PSNR, that of an exact fit.
Json EncodeDecibels(double x) { return std::isfinite(x) ? Json(x) : Json(); }

double DecodeDecibels(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::infinity() : json.get<double>();
}

Json Encode(const SceneScore& score) {
  Json json = {{"objective", score.objective}, {"psnr_db", EncodeDecibels(score.psnr_db)}};
  if (score.mean_delta_e) {
    json["mean_delta_e"] = *score.mean_delta_e;
    json["seen_psnr_db"] = EncodeDecibels(*score.seen_psnr_db);
  }
  return json;
}

SceneScore DecodeScore(const Json& json) {
  SceneScore score = {json.at("objective"), DecodeDecibels(json.at("psnr_db"))};
  if (json.contains("mean_delta_e")) {
    score.mean_delta_e = json.at("mean_delta_e");
    score.seen_psnr_db = DecodeDecibels(json.at("seen_psnr_db"));
  }
  return score;
}

Json Encode(const MaterialFit& fit) {
  Json decisions = Json::array();
  for (const PruneDecision& decision : fit.decisions) {
    decisions.push_back({{"what", decision.what},
                         {"numbers_before", decision.parameters_before},
                         {"numbers_after", decision.parameters_after},
                         {"E_before", decision.E_before},
                         {"E_after", decision.E_after},
                         {"taken", decision.taken},
                         {"adds", decision.adds},
                         {"why", decision.why}});
  }
  return {{"model", FormatModel(fit.file)},   {"valid_samples", fit.valid_samples},
          {"used_samples", fit.used_samples}, {"full_numbers", fit.full_parameters},
          {"full", Encode(fit.full)},         {"pruned", Encode(fit.pruned)},
          {"numbers", fit.num_parameters},    {"decisions", decisions},
          {"fit_seconds", fit.fit_seconds},   {"prune_seconds", fit.prune_seconds},
          {"data_notes", fit.data_notes},     {"verdict", fit.verdict},
          {"by_reads", fit.judged_by_reads},  {"misses_budget", fit.misses_budget}};
}

MaterialFit DecodeMaterialFit(const Json& json) {
  MaterialFit fit;
  fit.data_notes = json.at("data_notes");
  fit.verdict = json.at("verdict");
  fit.judged_by_reads = json.at("by_reads");
  fit.misses_budget = json.at("misses_budget");
  fit.valid_samples = json.at("valid_samples");
  fit.used_samples = json.at("used_samples");
  fit.full_parameters = json.at("full_numbers");
  fit.full = DecodeScore(json.at("full"));
  fit.pruned = DecodeScore(json.at("pruned"));
  fit.file = ParseModel(json.at("model").get<std::string>(), "cache");
  fit.num_parameters = json.at("numbers");
  for (const Json& decision : json.at("decisions")) {
    fit.decisions.push_back({.what = decision.at("what"),
                             .parameters_before = decision.at("numbers_before"),
                             .parameters_after = decision.at("numbers_after"),
                             .E_before = decision.at("E_before"),
                             .E_after = decision.at("E_after"),
                             .taken = decision.at("taken"),
                             .adds = decision.at("adds"),
                             .why = decision.at("why")});
  }
  fit.fit_seconds = json.at("fit_seconds");
  fit.prune_seconds = json.at("prune_seconds");
  fit.fit_from_cache = fit.prune_from_cache = true;
  return fit;
}

template <typename Fit>
std::optional<Fit> Cached(const FitCache& cache, const std::string& key,
                          Fit (*decode)(const Json&)) {
  const std::optional<std::string> content = cache.Find(key);
  if (!content) return std::nullopt;
  try {
    return decode(Json::parse(*content));
  } catch (const Json::exception&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

std::string FullFitKey(const SceneMaterial& material, const SceneFitSettings& settings,
                       const std::string& source_hash, const std::string& purpose) {
  return KeyOfFullFit(material, settings, source_hash, purpose).text();
}

std::string MaterialFitKey(const SceneMaterial& material, const SceneFitSettings& settings,
                           const std::string& source_hash) {
  Key key = KeyOfFullFit(material, settings, source_hash, "scene");
  key.Add("then", "prune 10");
  key.Add("unit", static_cast<int>(material.budget.unit));
  key.Add("amount", material.budget.amount);
  if (material.budget.of_appearance()) {
    key.Add("lights", settings.appearance.lights);
    key.Add("size", settings.appearance.size);
  }
  const SceneReductions& reductions = material.reductions;
  key.Add("lobes", reductions.lobes);
  key.Add("colour", reductions.colour);
  key.Add("shadowing", reductions.shadowing);
  key.Add("tables", reductions.tables);
  key.Add("verdict", settings.verdicts);
  return key.text();
}

std::optional<FullFit> CachedFullFit(const FitCache& cache, const std::string& key) {
  return Cached(cache, key, DecodeFullFit);
}

std::optional<MaterialFit> CachedMaterialFit(const FitCache& cache, const std::string& key) {
  return Cached(cache, key, DecodeMaterialFit);
}

void KeepFit(const FullFit& fit, const std::string& key, const FitCache& cache) {
  cache.Keep(key, Encode(fit).dump());
}

void KeepFit(const MaterialFit& fit, const std::string& key, const FitCache& cache) {
  cache.Keep(key, Encode(fit).dump());
}

}  // namespace trilobe
