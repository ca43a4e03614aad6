#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "app/command.h"
#include "app/fit_many.h"
#include "app/fit_page.h"
#include "app/fit_run.h"
#include "app/fit_settings.h"
#include "app/flags.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/result_folder.h"
#include "app/scene_plan.h"
#include "app/scene_run.h"
#include "app/solver_flags.h"
#include "app/status.h"
#include "core/algebra/openblas.h"
#include "fit/reports/fit_details.h"
#include "fit/reports/fit_report.h"
#include "fit/reports/print.h"
#include "io/pictures/gnuplot.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

DECLARE_bool(plots);
DECLARE_bool(reconstruction);
DECLARE_bool(convergence);
DEFINE_string(scene, "", "scene file (docs/scene.md): fit its materials, instead of a SOURCE");

namespace trilobe {
namespace {

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

int RunFitOfOne(const std::string& source) {
  FitSettings settings = FitSettingsFromFlags();
  settings.plots = settings.view = FLAGS_plots;
  if (settings.plots && IsDefault("plots") && !HaveGnuplot()) {
    std::cerr
        << "trilobe: no pictures, as gnuplot is not installed; --noplots is silent about it\n";
    settings.plots = false;
  }
  std::optional<ResultFolder> folder;
  // Flags that ask for files imply a folder for them.
  const bool wants_files = settings.plots || settings.reconstruction || settings.convergence;
  const std::string out = FLAGS_out.empty() && wants_files ? "out/" + FitNameOf(source) : FLAGS_out;
  if (!out.empty()) {
    std::vector<std::string> inputs = settings.inputs;
    inputs.push_back(source);
    folder.emplace(out, FitFileNames(), Inputs(inputs));
  }
  ResultFolder* const into = folder ? &*folder : nullptr;
  const int threads = ThreadsFromFlags();
  std::optional<InterruptGuard> guard;  // while it reads, Ctrl-C ends it at once
  settings.fit.on_stage = Status::Stage;
  Status::Stage("reading " + source);
  std::optional<Progress> progress;
  const auto show = [&](const auto& what) {
    if (!progress) progress.emplace(settings.fit.solver_options(ModelSpec()), FLAGS_verbose);
    progress->Show(what);
  };
  FitRun run = *RunOneFit(
      source, settings, threads, into, [&] { guard.emplace(); }, show, show);
  Status::End();
  PrintSummary(run.report);
  if (FLAGS_verbose) PrintDetails(run.report);
  if (!run.earlier.empty()) {
    PrintLine("kept         the earlier model, of " + run.earlier + ", as " + kPreviousModelName);
  }
  std::cout << std::flush;  // drawing takes a while
  bool is_full = false;
  if (into == nullptr) {
    PrintSeconds(run.report);
    std::cout << "written      nothing; give --out=DIR to keep the model\n";
  } else {
    if (settings.plots) Status::Stage("drawing pictures");
    const std::string undrawn = WriteOtherFiles(&run, settings, into);
    Status::End();
    is_full = !undrawn.empty() && TellMissingPictures(undrawn, out);
    PrintSeconds(run.report);
    PrintLine("written      " + Joined(run.report.files) + " in " + out);
  }
  if (run.report.interrupted) return 128 + InterruptGuard::signal();  // as a shell reports it
  return is_full ? 1 : 0;
}

// A scene says what is fitted and, by its budgets, what models come out.
int RunFitOfScene(std::span<const std::string> arguments) {
  if (!arguments.empty()) {
    throw Error(ErrorKind::kConflict,
                "--scene names the sources in its file; leave out " + arguments[0])
        .About("scene", arguments[0]);
  }
  std::vector<std::string> taken = SceneFlags();
  taken.insert(taken.end(), {"scene", "out", "force"});
  for (const auto& [flag, value] : GivenFlags(FitFlags())) {
    if (std::ranges::find(taken, flag) != taken.end()) continue;
    throw Error(ErrorKind::kConflict,
                "--" + flag + " is for the fit of one SOURCE, not for --scene")
        .About(flag, value);
  }
  return RunSceneFit(FLAGS_scene);
}

int RunFit(std::span<const std::string> arguments) {
  { const BlasCall memory_is_there; }  // which is better known before the work
  if (!FLAGS_scene.empty()) return RunFitOfScene(arguments);
  if (arguments.empty()) {
    throw Error(ErrorKind::kMissing, "trilobe fit needs a SOURCE, or --scene=SCENE")
        .About("SOURCE");
  }
  for (const char* const flag : {"cache", "nocache"}) {
    if (!IsDefault(flag)) {
      throw Error(ErrorKind::kConflict, "--" + std::string(flag) + " goes with --scene")
          .About(flag);
    }
  }
  std::error_code ignored;
  if (arguments.size() == 1 && IsDefault("shard") &&
      !std::filesystem::is_directory(arguments[0], ignored)) {
    return RunFitOfOne(arguments[0]);
  }
  return RunFitOfMany(arguments, FitSettingsFromFlags());
}

// "  name  description" a line, from a registry.
template <typename T>
std::string ListEntries(const std::vector<T>& entries) {
  size_t width = 0;
  for (const T& entry : entries) width = std::max(width, entry.name.size());
  std::string text;
  for (const T& entry : entries) {
    text += "  " + entry.name + std::string(width + 2 - entry.name.size(), ' ') +
            entry.description + "\n";
  }
  return text;
}

}  // namespace

Command FitCommand() {
  return {
      .name = "fit",
      .summary = "fit a model to a measurement",
      .arguments = "SOURCE... | --scene=SCENE",
      .min_arguments = 0,
      .max_arguments = std::numeric_limits<int>::max(),
      .details =
          "Prints first what a person would see of the fit beside its measurement; with --verbose "
          "all there is to\nsay. Writes DIR/model.json (the model, in canonical form), "
          "DIR/trace.csv (E, step and "
          "seconds of\neach iteration; row 0 is the starting point), DIR/report.json "
          "(settings, errors, diagnosis,\ntimes), DIR/view.html (a page to look at, `trilobe "
          "view`) "
          "and the pictures of `trilobe plot`. Ctrl-C stops "
          "after the iteration and keeps "
          "the best model so far; go on from it, with the\nsame solver or another, with "
          "--init=DIR/model.json.\n\nSeveral sources, or a folder of measurements, are fitted "
          "side by side, each into a folder of its name\nin DIR; DIR/fits.csv and "
          "DIR/index.html, a page of pictures, gather them. What DIR has already, of\nthe "
          "same measurement and flags, is not fitted again; one that fails does not stop the "
          "others, and\nmakes the exit status 3. --shard=i/n shares them out between machines "
          "(docs/batch.md).\n\nWith --scene, does what `trilobe plan` says for the "
          "materials of a scene file, side by side, and\nwrites DIR/NAME.json (a model) for "
          "each, DIR/plan.json and DIR/plan.txt. Ctrl-C keeps what is\nfinished; the same "
          "command goes on with the others.\n\n`trilobe help fit --solver=NAME` shows the flags of "
          "another solver than this; `trilobe solvers` lists all:",
      .flags = FitFlags(),
      .lists = "solvers:\n" + ListEntries(Solvers()) + "\nstarting points (--init):\n" +
               ListEntries(InitialModels()) + "\nweightings:\n" + ListEntries(Weightings()),
      .particular_flags = ParticularSolverFlags(),
      .particular_help = [] { return DescribeSolver(SolverFromFlags()); },
      .run = RunFit};
}

}  // namespace trilobe
