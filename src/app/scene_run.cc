#include "app/scene_run.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/fit_flags.h"
#include "app/flags.h"
#include "app/interrupt.h"
#include "app/program.h"
#include "app/progress.h"
#include "app/solver_flags.h"
#include "core/base/file_names.h"
#include "core/system/process.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"

DEFINE_string(cache, "",
              "folder where fits are kept for the next time; $XDG_CACHE_HOME/trilobe if "
              "not given; safe to delete");
DEFINE_bool(nocache, false, "neither use nor keep fits");

namespace trilobe {
namespace {

FitCache CacheFromFlags() {
  if (FLAGS_nocache) {
    if (!FLAGS_cache.empty()) {
      throw Error(ErrorKind::kConflict, "--nocache and --cache contradict; leave one out")
          .About("nocache");
    }
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

}  // namespace

std::vector<std::string> SceneFlags() {
  std::vector<std::string> flags = WithSourceFlags(SceneFitOptionFlags());
  flags.insert(flags.end(), {"max_iterations", "max_seconds", "tolerance", "optimality_tolerance",
                             "cache", "nocache"});
  return flags;
}

std::vector<std::string> SceneModelFlags() {
  std::vector<std::string> flags = SceneFlags();
  for (const char* const flag : {"threads", "cache", "nocache"}) std::erase(flags, flag);
  for (const std::string& flag : ParticularSolverFlags()) flags.push_back(flag);
  return flags;
}

SceneFitSettings SceneSettingsFromFlags() {
  FitOptions fit = FitOptionsFromFlags();
  const SolverOptions solver_options = fit.solver_options(ModelSpec());
  SceneFitSettings settings{.fit = std::move(fit),
                            .source = SourceOptionsFromFlags(/*has_starts=*/true),
                            .options = solver_options,
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
  std::vector<std::string> folders;
  for (const std::string& file : FilesOf(run.scene)) {
    folders.push_back(std::filesystem::path(file).parent_path().string());
  }
  double when_made = 0;
  for (size_t k = 0; k < results.size(); ++k) {
    const auto& [fit, error] = results[k];
    if (!error.empty()) {
      // The plan may go to others.
      run.failures.push_back({run.scene.materials[k].name, WithoutFolders(error, folders)});
    }
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

}  // namespace trilobe
