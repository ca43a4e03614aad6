#include "trilobe/app/scene_run.h"

#include <gflags/gflags.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "trilobe/app/flags.h"
#include "trilobe/app/inputs.h"
#include "trilobe/app/progress.h"
#include "trilobe/app/scene_report.h"
#include "trilobe/app/solver_flags.h"
#include "trilobe/base/error.h"
#include "trilobe/base/stopwatch.h"
#include "trilobe/io/file.h"
#include "trilobe/io/source.h"
#include "trilobe/model/weighting.h"
#include "trilobe/solvers/initial_model.h"

DEFINE_string(cache, "",
              "folder where fits are kept for the next time; $XDG_CACHE_HOME/trilobe if "
              "not given; safe to delete");
DEFINE_bool(nocache, false, "neither use nor keep fits");

namespace trilobe {
namespace {

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

// "\r3 of 10 materials" on a terminal.
class SceneProgress {
 public:
  explicit SceneProgress(size_t count) : count_(count) { Show(); }
  ~SceneProgress() {
    if (on_terminal_) std::fputs("\r\033[K", stderr);
  }
  SceneProgress(const SceneProgress&) = delete;
  SceneProgress& operator=(const SceneProgress&) = delete;

  void Done(const std::string& name) {
    ++done_;
    last_ = ", last " + name;
    Show();
  }

 private:
  void Show() const {
    if (!on_terminal_) return;
    std::fprintf(stderr, "\r\033[K%zu of %zu materials finished%s", done_, count_, last_.c_str());
    std::fflush(stderr);
  }

  const bool on_terminal_ = isatty(STDERR_FILENO) != 0;
  const size_t count_;
  size_t done_ = 0;
  std::string last_;
};

}  // namespace

std::vector<std::string> SceneFlags() {
  return {"solver",
          "weighting",
          "lobes",
          "max_iterations",
          "max_seconds",
          "tolerance",
          "optimality_tolerance",
          "threads",
          "noise",
          "seed",
          "max_angle",
          "extrapolated",
          "cache",
          "nocache"};
}

std::vector<std::string> SceneModelFlags() {
  std::vector<std::string> flags = SceneFlags();
  for (const char* const flag : {"threads", "cache", "nocache"}) std::erase(flags, flag);
  for (const std::string& flag : ParticularSolverFlags()) flags.push_back(flag);
  return flags;
}

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
                            .extrapolated = source.extrapolated,
                            .program = std::string("trilobe ") + gflags::VersionString(),
                            .cache = CacheFromFlags(),
                            .stop = [] { return InterruptGuard::signal() != 0; }};
  settings.options.diagnose = false;  // nobody would see it
  return settings;
}

SceneRun RunScene(Scene scene, const SceneFitSettings& settings,
                  const std::function<void(const MaterialFit&)>& on_done) {
  SceneRun run{.scene = std::move(scene), .threads = ThreadsFromFlags()};
  const InterruptGuard guard;
  SceneProgress progress(run.scene.materials.size());
  Stopwatch stopwatch;
  const auto fits = FitScene(run.scene, settings, run.threads, [&](const MaterialFit& fit) {
    on_done(fit);
    progress.Done(fit.name);
  });
  run.seconds = stopwatch.Lap();
  double when_made = 0;
  for (const std::optional<MaterialFit>& fit : fits) {
    if (!fit) continue;
    run.fits.push_back(*fit);
    run.reused += fit->fit_from_cache ? 1 : 0;
    when_made += fit->fit_seconds + fit->prune_seconds;
  }
  if (run.reused > 0) {
    run.seconds = when_made / std::min<double>(run.threads, static_cast<double>(fits.size()));
  }
  run.interrupted = InterruptGuard::signal();
  return run;
}

int RunSceneFit(const std::string& path) {
  const std::string folder = RequiredOut("fit --scene", "DIR");
  const SceneFitSettings settings = SceneSettingsFromFlags();
  Scene scene = ReadScene(path);  // its errors come before anything is made
  MakeDirectories(folder);
  const SceneRun run = RunScene(std::move(scene), settings, [&](const MaterialFit& fit) {
    WriteModel(fit.file, folder + "/" + fit.name + ".json");
  });
  std::ostringstream text;
  PrintPlan(run, text);
  std::cout << text.str();
  WriteFile(folder + "/plan.txt", [&](std::ostream& out) { out << text.str(); });
  WriteFile(folder + "/plan.json",
            [&](std::ostream& out) { out << PlanToJson(run).dump(2) << "\n"; });
  std::cout << "\nwritten: " << run.fits.size() << " models, plan.json, plan.txt in " << folder
            << "\n";
  if (run.interrupted != 0) {
    std::cout << "interrupted: the same command goes on with the others\n";
    return 128 + run.interrupted;
  }
  return 0;
}

}  // namespace trilobe
