#include "app/scene_run.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "app/appearance_flags.h"
#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/interrupt.h"
#include "app/program.h"
#include "app/progress.h"
#include "app/result_folder.h"
#include "app/scene_flags.h"
#include "app/scene_report.h"
#include "app/solver_flags.h"
#include "core/files/json_value.h"
#include "core/system/stopwatch.h"
#include "fit/reports/appearance_report.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/solvers/start/initial_model.h"

DEFINE_string(cache, "",
              "folder where fits are kept for the next time; $XDG_CACHE_HOME/trilobe if "
              "not given; safe to delete");
DEFINE_bool(nocache, false, "neither use nor keep fits");

namespace trilobe {
namespace {

constexpr const char* kPlanName = "plan.json";
constexpr const char* kPlanTextName = "plan.txt";

FitCache CacheFromFlags() {
  if (FLAGS_nocache) {
    if (!FLAGS_cache.empty()) throw Error("--nocache and --cache contradict; leave one out");
    return {};
  }
  if (!FLAGS_cache.empty()) return FitCache(FLAGS_cache);
  const std::string folder = DefaultCacheFolder();
  try {
    return folder.empty() ? FitCache() : FitCache(folder);
  } catch (const Error&) {
    return {};  // a home that cannot be written to, which nobody asked for
  }
}

// Names of the files that the scene leaves in its folder, and of those that an earlier one has left
// there by what its plan says.
std::vector<std::string> SceneFileNames(const Scene& scene, const std::string& folder) {
  std::set<std::string> names = {kPlanTextName};
  for (const SceneMaterial& material : scene.materials) names.insert(material.name + ".json");
  const std::string plan = folder + "/" + kPlanName;
  try {
    const auto earlier = nlohmann::json::parse(ReadJsonText(plan, plan + ": not a plan"));
    if (earlier.contains("files")) {
      for (const std::string file : earlier.at("files")) {
        if (file.find('/') == std::string::npos) names.insert(file);
      }
    } else {  // of an earlier version
      for (const auto& material : earlier.at("materials")) {
        names.insert(material.at("name").get<std::string>() + ".json");
      }
    }
    names.erase(kPlanName);
  } catch (const Error&) {
    // There was none.
  } catch (const nlohmann::json::exception&) {
    throw Error("'" + plan + "' is not a plan of `trilobe fit --scene`; give another --out");
  }
  std::vector<std::string> in_order = {kPlanName};
  in_order.insert(in_order.end(), names.begin(), names.end());
  return in_order;
}

}  // namespace

SceneFitSettings SceneSettingsFromFlags() {
  const SolverEntry& solver = SolverFromFlags();
  const ModelSpec spec = ModelSpec::SharedFactors(FLAGS_lobes);
  CheckSpec(spec);
  const SourceOptions source = SourceOptionsFromFlags();
  SceneFitSettings settings{.solver = solver.name,
                            .options = SolverOptionsFromFlags(solver, spec),
                            .init = InitialModels().front().name,
                            .weighting = FindWeighting(FLAGS_weighting).name,
                            .lobes = FLAGS_lobes,
                            .noise = source.noise,
                            .seed = source.seed,
                            .max_angle_deg = source.max_angle_deg,
                            .min_theta_d_deg = source.min_theta_d_deg,
                            .extrapolated = source.extrapolated,
                            .program = ProgramName(),
                            .build = ProgramBuild(),
                            .appearance = AppearanceOptionsFromFlags(),
                            .verdicts = true,
                            .cache = CacheFromFlags(),
                            .stop = [] { return InterruptGuard::signal() != 0; }};
  settings.options.diagnose = false;  // nobody would see it
  return settings;
}

SceneRun RunScene(Scene scene, const SceneFitSettings& settings,
                  const std::function<void(const MaterialFit&)>& on_done) {
  SceneRun run{.scene = std::move(scene), .threads = ThreadsFromFlags()};
  JobProgress progress(run.scene.materials.size(), "materials");
  Stopwatch stopwatch;
  const std::vector<MaterialResult> results =
      FitScene(run.scene, settings, run.threads, [&](const MaterialFit& fit) {
        on_done(fit);
        progress.Done(fit.name, !fit.prune_from_cache);
      });
  run.seconds = stopwatch.Lap();
  double when_made = 0;
  for (size_t k = 0; k < results.size(); ++k) {
    const auto& [fit, error] = results[k];
    if (!error.empty()) run.failures.push_back({run.scene.materials[k].name, error});
    if (!fit) continue;
    run.fits.push_back(*fit);
    run.reused += fit->fit_from_cache ? 1 : 0;
    when_made += fit->fit_seconds + fit->prune_seconds;
  }
  if (run.reused > 0) {
    run.seconds = when_made / std::min<double>(run.threads, static_cast<double>(results.size()));
  }
  run.interrupted = InterruptGuard::signal();
  return run;
}

int RunSceneFit(const std::string& path) {
  const std::string out = RequiredOut("fit --scene", "DIR");
  const SceneFitSettings settings = SceneSettingsFromFlags();
  Scene scene = ReadScene(path);
  const std::vector<std::string> names = SceneFileNames(scene, out);
  ResultFolder folder(out, names, {kPlanName}, Inputs(FilesOf(scene)));
  folder.Open();
  const auto plan_text = [&](nlohmann::ordered_json plan, const std::vector<std::string>& files) {
    plan["run"] = folder.run();
    plan["files"] = files;
    return plan.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
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
  }
  if (run.interrupted != 0) {
    std::cout << "interrupted"
              << (FLAGS_nocache ? "" : ": the same command goes on with the others") << "\n";
    return 128 + run.interrupted;
  }
  return run.failures.empty() ? 0 : kSomeFailed;
}

}  // namespace trilobe
