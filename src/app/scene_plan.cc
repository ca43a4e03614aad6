#include "app/scene_plan.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/interrupt.h"
#include "app/program.h"
#include "app/result_folder.h"
#include "core/base/file_names.h"
#include "core/base/json_text.h"
#include "core/files/file.h"
#include "core/files/json_value.h"
#include "core/files/own_mark.h"
#include "core/system/content_hash.h"
#include "fit/reports/print.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/io/formats/model_file.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kPlanName = "plan.json";
constexpr const char* kPlanTextName = "plan.txt";

std::string BudgetText(const SceneBudget& budget) {
  const std::string amount = Text(budget.amount);
  switch (budget.unit) {
    case SceneBudget::Unit::kRelativeRise:
      return "E may rise by " + Text(100 * budget.amount) + " %";
    case SceneBudget::Unit::kPsnrDrop:
      return "PSNR may fall by " + amount + " dB";
    case SceneBudget::Unit::kMeanDeltaE:
      return "mean Delta E may be " + amount;
    case SceneBudget::Unit::kSpherePsnr:
      return "the PSNR of what is seen must be " + amount + " dB";
    case SceneBudget::Unit::kBytes:
      return "at most " + amount + " bytes";
    case SceneBudget::Unit::kSeconds:
      return "at most " + amount + " seconds";
  }
  return "";
}

Json ToJson(const SceneBudget& budget) {
  switch (budget.unit) {
    case SceneBudget::Unit::kRelativeRise:
      return {{"relative_rise", budget.amount}};
    case SceneBudget::Unit::kPsnrDrop:
      return {{"psnr_drop_db", budget.amount}};
    case SceneBudget::Unit::kMeanDeltaE:
      return {{"mean_delta_e", budget.amount}};
    case SceneBudget::Unit::kSpherePsnr:
      return {{"sphere_psnr_db", budget.amount}};
    case SceneBudget::Unit::kBytes:
      return {{"bytes", budget.amount}};
    case SceneBudget::Unit::kSeconds:
      return {{"seconds", budget.amount}};
  }
  return {};
}

const SceneMaterial& MaterialOf(const SceneRun& run, const MaterialFit& fit) {
  return *std::ranges::find(run.scene.materials, fit.name, &SceneMaterial::name);
}

// "1.2 %", or of a model that is exact, that it was.
std::string RiseText(const MaterialFit& fit) {
  constexpr double kMost = 1e6;
  const double rise = RelativeRise(fit.full, fit.pruned);
  return rise > kMost ? "from 0" : Text(100 * rise, 3) + " %";
}

const char* HeadOf(const PruneDecision& decision) {
  if (decision.adds) return decision.taken ? "  added:    " : "  not added: ";
  return decision.taken ? "  left out: " : "  not taken: ";
}

void PrintDecisions(const SceneRun& run, const MaterialFit& fit, std::ostream& out) {
  const SceneMaterial& material = MaterialOf(run, fit);
  out << "\n"
      << Printable(fit.name + ": " + FileNameOf(material.source)) << "; "
      << BudgetText(material.budget) << "\n";
  out << "  verdict:  " << fit.verdict << "\n";
  if (fit.full.mean_delta_e) {
    const auto line = [&](const char* what, const SceneScore& score) {
      out << what << "mean Delta E " << Text(*score.mean_delta_e, 3) << ", PSNR "
          << Text(*score.seen_psnr_db, 4) << " dB";
    };
    out << (fit.judged_by_reads ? "  reads:    " : "  sphere:   ");
    line("with nothing left out ", fit.full);
    line("; as it is ", fit.pruned);
    out << "\n";
  }
  for (const std::string& note : fit.data_notes) out << "  note:     " << Printable(note) << "\n";
  if (fit.used_samples < fit.valid_samples) {
    out << "  left out: " << fit.valid_samples - fit.used_samples << " of " << fit.valid_samples
        << " samples, in directions that the scene does not use\n";
  }
  if (material.channels == SceneChannels::kLuminance) out << "  left out: colour, by the scene\n";
  for (const PruneDecision& decision : fit.decisions) {
    out << HeadOf(decision) << decision.what;
    if (decision.parameters_after != decision.parameters_before ||
        decision.E_after != decision.E_before) {
      out << ": " << decision.parameters_before << " -> " << decision.parameters_after
          << " parameters, E " << Text(decision.E_before, 6) << " -> " << Text(decision.E_after, 6);
    }
    if (!decision.why.empty()) out << "; " << decision.why;
    out << "\n";
  }
}

Json ToJson(const SceneRun& run, const MaterialFit& fit) {
  const SceneMaterial& material = MaterialOf(run, fit);
  Json decisions = Json::array();
  for (const PruneDecision& decision : fit.decisions) {
    decisions.push_back({{"what", decision.what},
                         {"taken", decision.taken},
                         {"adds", decision.adds},
                         {"why", decision.why},
                         {"parameters_before", decision.parameters_before},
                         {"parameters_after", decision.parameters_after},
                         {"objective_before", decision.E_before},
                         {"objective_after", decision.E_after}});
  }
  Json json = {
      {"name", fit.name},
      {"source", FileNameOf(material.source)},
      {"verdict", fit.verdict},
      {"data_notes", fit.data_notes},
      {"budget", ToJson(material.budget)},
      {"misses_budget", fit.misses_budget},
      {"samples", {{"valid", fit.valid_samples}, {"used", fit.used_samples}}},
      {"lobes", fit.file.model.spec().lobes},
      {"parameters", {{"full", fit.full_parameters}, {"pruned", fit.num_parameters}}},
      {"bytes", {{"full", BytesOf(fit.full_parameters)}, {"pruned", BytesOf(fit.num_parameters)}}},
      {"objective", {{"full", fit.full.objective}, {"pruned", fit.pruned.objective}}},
      {"relative_rise", RelativeRise(fit.full, fit.pruned)},
      {"psnr_db", {{"full", fit.full.psnr_db}, {"pruned", fit.pruned.psnr_db}}},
      {"seconds", {{"fit", fit.fit_seconds}, {"prune", fit.prune_seconds}}},
      {"from_cache", {{"fit", fit.fit_from_cache}, {"prune", fit.prune_from_cache}}},
      {"decisions", decisions}};
  if (fit.full.mean_delta_e) {
    json["mean_delta_e"] = {{"full", *fit.full.mean_delta_e}, {"pruned", *fit.pruned.mean_delta_e}};
    json["seen_psnr_db"] = {{"full", *fit.full.seen_psnr_db}, {"pruned", *fit.pruned.seen_psnr_db}};
    json["judged_by"] = fit.judged_by_reads ? "reads" : "sphere";
  }
  return json;
}

// The plan that a scene has left in a folder; null if there is none. Throws Error for another file.
nlohmann::json EarlierPlan(const std::string& folder) {
  const std::string path = folder + "/" + kPlanName;
  CheckMayReplace(path);
  try {
    const std::string text = ReadJsonText(path, "not a plan");
    if (SaysOwn(text)) return nlohmann::json::parse(text);
  } catch (const Error&) {
    return nullptr;  // none
  }
  return nullptr;  // --force
}

// Names of the files that an earlier scene has left, by what its plan says.
std::set<std::string> FilesOfPlan(const nlohmann::json& plan) {
  std::set<std::string> names;
  if (plan.is_null()) return names;
  try {
    if (plan.contains("files")) {
      for (const std::string file : plan.at("files")) {
        if (file.find('/') == std::string::npos) names.insert(file);
      }
    } else {  // of an earlier version
      for (const auto& material : plan.at("materials")) {
        names.insert(material.at("name").get<std::string>() + ".json");
      }
    }
  } catch (const nlohmann::json::exception&) {
    names.clear();  // damaged since
  }
  names.erase(kPlanName);
  return names;
}

// Names of the files that the scene leaves in its folder, and of those that an earlier one has.
std::vector<std::string> SceneFileNames(const Scene& scene, const std::set<std::string>& earlier) {
  std::set<std::string> names = earlier;
  names.insert(kPlanTextName);
  for (const SceneMaterial& material : scene.materials) names.insert(material.name + ".json");
  std::vector<std::string> in_order = {kPlanName};
  in_order.insert(in_order.end(), names.begin(), names.end());
  return in_order;
}

// Hash of all that the models depend on: program, flags, and content of the files.
std::string KeyOf(const Scene& scene) {
  std::string key = ProgramName() + "\n";
  for (const auto& [flag, value] : GivenFlags(SceneModelFlags())) key += flag + "=" + value + "\n";
  for (const std::string& file : FilesOf(scene)) key += ContentHash(ReadFile(file)) + "\n";
  return ContentHash(key);
}

// Has the folder keep the models in it that this scene does not make again. Returns how many.
int KeepEarlierModels(const nlohmann::json& plan, const std::set<std::string>& files,
                      const std::string& key, ResultFolder* folder) {
  const bool same = plan.contains("key") && plan.at("key") == key;
  int kept = 0;
  for (const std::string& file : folder->Files()) {
    if (!file.ends_with(".json") || file == kPlanName || (same && files.contains(file))) continue;
    folder->KeepEarlier(file);
    ++kept;
  }
  return kept;
}

}  // namespace

void PrintPlan(const SceneRun& run, std::ostream& out) {
  size_t width = 10;
  for (const MaterialFit& fit : run.fits) width = std::max(width, fit.name.size() + 2);
  const auto name = [&](const std::string& text) {
    const std::string shown = Printable(text);
    return shown + std::string(shown.size() < width ? width - shown.size() : 1, ' ');
  };
  out << name("material")
      << " lobes   stored  of full    bytes  E rises by  PSNR falls by  seconds\n";
  int full = 0, pruned = 0;
  double seconds = 0;
  for (const MaterialFit& fit : run.fits) {
    full += fit.full_parameters;
    pruned += fit.num_parameters;
    seconds += fit.fit_seconds + fit.prune_seconds;
    out << name(fit.name) << AlignRight(std::to_string(fit.file.model.spec().lobes), 6)
        << AlignRight(std::to_string(fit.num_parameters), 9)
        << AlignRight(std::to_string(fit.full_parameters), 9)
        << AlignRight(std::to_string(BytesOf(fit.num_parameters)), 9)
        << AlignRight(RiseText(fit), 12)
        << AlignRight(Text(PsnrFall(fit.full.psnr_db, fit.pruned.psnr_db), 3) + " dB", 15)
        << AlignRight(Text(fit.fit_seconds + fit.prune_seconds, 3), 9)
        << (fit.prune_from_cache ? "  from the cache"
            : fit.fit_from_cache ? "  the fit from the cache"
                                 : "")
        << "\n";
  }
  out << name("all") << AlignRight("", 6) << AlignRight(std::to_string(pruned), 9)
      << AlignRight(std::to_string(full), 9) << AlignRight(std::to_string(BytesOf(pruned)), 9)
      << AlignRight("", 27) << AlignRight(Text(seconds, 3), 9) << "\n"
      << Text(run.seconds, 3) << " seconds side by side on " << run.threads << " threads"
      << (run.reused > 0 ? ", reckoned from what the parts took when they were made" : "") << "\n";
  constexpr double kMuch = 0.1;
  if (std::ranges::any_of(run.fits, [](const MaterialFit& fit) {
        return RelativeRise(fit.full, fit.pruned) > kMuch;
      })) {
    out << "E is the error that fits minimise. It may rise by much and not be seen where it was "
           "small: the verdicts below say what a person sees.\n";
  }
  for (const MaterialFit& fit : run.fits) PrintDecisions(run, fit, out);
  for (const auto& [material, error] : run.failures) {
    out << "\n" << Printable(material) << " failed: " << error << "\n";
  }
}

Json PlanToJson(const SceneRun& run) {
  Json materials = Json::array();
  for (const MaterialFit& fit : run.fits) materials.push_back(ToJson(run, fit));
  Json failed = Json::array();
  for (const auto& [name, error] : run.failures) {
    failed.push_back({{"name", name}, {"error", error}});
  }
  return {{"scene", std::filesystem::absolute(run.scene.path).lexically_normal().string()},
          {"flags", GivenFlags(SceneModelFlags())},
          {"threads", run.threads},
          {"seconds", run.seconds},
          {"reused", run.reused},
          {"materials", materials},
          {"failed", failed}};
}

int RunSceneFit(const std::string& path) {
  const std::string out = RequiredOut("fit --scene", "DIR");
  const SceneFitSettings settings = SceneSettingsFromFlags();
  Scene scene = ReadScene(path);
  const nlohmann::json earlier = EarlierPlan(out);
  const std::set<std::string> earlier_files = FilesOfPlan(earlier);
  const std::vector<std::string> names = SceneFileNames(scene, earlier_files);
  const std::string key = KeyOf(scene);
  ResultFolder folder(out, names, Inputs(FilesOf(scene)));
  const int kept = KeepEarlierModels(earlier, earlier_files, key, &folder);
  folder.Open();
  const auto plan_text = [&](const nlohmann::ordered_json& plan,
                             const std::vector<std::string>& files) {
    nlohmann::ordered_json marked = {{"format", kPlanFormat}};
    marked.update(plan);
    marked["run"] = folder.run();
    marked["key"] = key;
    marked["files"] = files;
    marked["checksums"] = folder.checksums();  // none: all of its files say who wrote them
    return JsonText(std::move(marked), 2) + "\n";
  };
  bool begun = false;
  const InterruptGuard guard;  // until the plan says what there is
  const SceneRun run = RunScene(std::move(scene), settings, [&](const MaterialFit& fit) {
    ModelFile file = fit.file;
    file.fit.run = folder.run();
    const std::string text = FormatModel(file);
    // Should the program be killed, the next run knows by this what there may be.
    if (!begun) {
      const std::string plan = plan_text({{"unfinished", true}}, names);
      folder.WriteAhead(kPlanName, [&](std::ostream& out) { out << plan; });
      begun = true;
    }
    folder.Write(fit.name + ".json", [&](std::ostream& out) { out << text; });
  });
  std::ostringstream text;
  PrintPlan(run, text);
  std::cout << text.str();
  if (!run.fits.empty()) {
    folder.Write(kPlanTextName, [&](std::ostream& out) { out << text.str(); });
    const std::string plan = plan_text(PlanToJson(run), folder.Files());
    folder.Write(kPlanName, [&](std::ostream& out) { out << plan; });
    std::cout << "\nwritten: " << run.fits.size() << " models, " << kPlanName << ", "
              << kPlanTextName << " in " << Printable(out) << "\n";
    if (kept > 0) {
      std::cout << "kept: " << kept << (kept == 1 ? " model" : " models")
                << " of an earlier scene, other flags or other files, as "
                << PreviousName("NAME.json") << "\n";
    }
  }
  if (run.interrupted != 0) {
    std::cout << "interrupted"
              << (FLAGS_nocache ? "" : ": the same command goes on with the others") << "\n";
    return 128 + run.interrupted;
  }
  return run.failures.empty() ? 0 : kSomeFailed;
}

}  // namespace trilobe
