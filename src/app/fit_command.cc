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
#include "app/flags.h"
#include "app/inputs.h"
#include "app/interrupt.h"
#include "app/model_flags.h"
#include "app/progress.h"
#include "app/result_folder.h"
#include "app/scene_plan.h"
#include "app/solver_flags.h"
#include "core/algebra/openblas.h"
#include "core/files/file.h"
#include "core/system/content_hash.h"
#include "fit/reports/fit_details.h"
#include "fit/reports/fit_report.h"
#include "fit/reports/print.h"
#include "fit/scene/fit_cache.h"
#include "io/pictures/gnuplot.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/materials/load_model.h"
#include "trilobe/solvers/registry/solvers.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/start/initial_model.h"

DEFINE_string(
    init, "analytic",
    "one of the starting points above, or the path of a model file, whose spec the fit then "
    "takes");
DEFINE_int32(max_parameters, 822,
             "with --model=auto: how many parameters the model may store; without it, of scattered "
             "samples, as many as their default form has");
DEFINE_double(
    robust, 0,
    "go on with a loss that is linear in the error, as the weighting sees it, beyond this, "
    "by reweighting; 0 for none");
DEFINE_double(
    smoothness, trilobe::FitOptions().smoothness,
    "let E rise by this share at the end for tables as smooth as that allows, where that is not "
    "seen: without holes, and without falls that D and G exchange; 0 is the least E");
DEFINE_bool(match_reflectance, true,
            "of a table: where a fit that has converged reflects more or less light than was "
            "measured, by more than 1 %, let E rise a little to mend that, as far as neither the "
            "sphere nor the mean log error gets worse");
DEFINE_bool(
    raw, false,
    "store the model that the solver found, as for comparing solvers: entries at the edge of "
    "the data are not tied, reflected light is not matched, tables are not smoothed");
DEFINE_string(scene, "", "scene file (docs/scene.md): fit its materials, instead of a SOURCE");
DEFINE_bool(reconstruction, false,
            "also write DIR/reconstruction.binary, the fit in MERL layout, or of an anisotropic "
            "model DIR/reconstruction.bin, in UTIA's");
DEFINE_bool(
    convergence, false,
    "also write DIR/convergence.csv: errors of the models on the way, scored when the fit is over");
DEFINE_bool(
    plots, true,
    "write the page of `trilobe view` and the pictures of `trilobe plot` into DIR; without --out "
    "that is out/NAME. Of several SOURCEs, only if asked for");

namespace trilobe {
namespace {

// The starting point is a file where --init is not a name but something like a path.
bool InitIsFile() {
  for (const InitialModel& init : InitialModels()) {
    if (init.name == FLAGS_init) return false;
  }
  if (IsMaterial(FLAGS_init)) return true;
  std::error_code ignored;
  return FLAGS_init.find('/') != std::string::npos || FLAGS_init.ends_with(".json") ||
         std::filesystem::exists(FLAGS_init, ignored);
}

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

FactorModel StartFromFile() {
  FactorModel model = ModelOfSource(FLAGS_init).model;
  if (ModelIsGiven()) {
    throw Error(FLAGS_init +
                " brings its own lobes and tables; leave out --model, --lobes, --stretch, "
                "--d_nodes, --f_bins, --g_nodes and --nodes");
  }
  return model;
}

// Flags on which a result does not depend, or only by the content of a file.
constexpr const char* kFlagsOfNoResult[] = {"threads", "out",     "scene", "shard",
                                            "cache",   "nocache", "probe", "verbose"};

std::vector<std::string> FitFlags() {
  std::vector<std::string> flags =
      WithSourceFlags({"solver", "init", "weighting", "prior", "robust", "smoothness",
                       "match_reflectance", "raw", "max_parameters"});
  for (const std::string& flag : ModelFlags()) flags.push_back(flag);
  for (const std::string& flag : CommonSolverFlags()) flags.push_back(flag);
  flags.insert(flags.end(), {"out", "reconstruction", "convergence", "plots", "verbose", "probe",
                             "shard", "scene", "cache", "nocache"});
  return flags;
}

// Flags by which other files are written, but the same model.
constexpr const char* kFlagsOfNoModel[] = {"reconstruction", "convergence", "plots", "diagnose"};

// `without`: flags that do not count.
std::string KeyOfFlags(std::span<const char* const> without) {
  std::vector<std::string> flags = FitFlags();
  for (const std::string& flag : ParticularSolverFlags()) flags.push_back(flag);
  std::string key;
  for (const char* const flag : kFlagsOfNoResult) std::erase(flags, flag);
  for (const char* const flag : without) std::erase(flags, flag);
  for (const auto& [flag, value] : GivenFlags(flags)) key += flag + "=" + value + "\n";
  return key;
}

FitSettings SettingsFromFlags() {
  FitSettings settings;
  FitOptions& fit = settings.fit;
  fit.weighting = FindWeighting(FLAGS_weighting);
  const SolverEntry& solver = SolverFromFlags();
  fit.solver = solver.name;
  fit.solver_options = [&solver](const ModelSpec& spec) {
    return SolverOptionsFromFlags(solver, spec);
  };
  fit.init = FLAGS_init;
  const bool init_is_file = InitIsFile();
  if (!init_is_file) FindInitialModel(FLAGS_init);  // its error
  if (!(FLAGS_robust >= 0 && FLAGS_robust <= 1e6)) throw Error("--robust must be from 0 to 1e6");
  if (!(FLAGS_smoothness >= 0 && FLAGS_smoothness <= 1)) {
    throw Error("--smoothness must be from 0 to 1");
  }
  if (ChoosesModel() && !IsDefault("smoothness") && FLAGS_smoothness > 0) {
    throw Error(
        "--smoothness is for a form that is given: tables that --model=auto chooses are thinned");
  }
  if (FLAGS_raw) {
    for (const char* const flag : {"robust", "smoothness", "match_reflectance"}) {
      if (!IsDefault(flag)) {
        throw Error("--raw stores what the solver found; leave out --" + std::string(flag));
      }
    }
    if (ChoosesModel()) throw Error("--raw stores what the solver found; leave out --model=auto");
  }
  if (FLAGS_max_parameters < 1) throw Error("--max_parameters must be at least 1");
  if (!ChoosesModel() && !IsDefault("max_parameters")) {
    throw Error("--max_parameters goes with --model=auto");
  }
  fit.robust = FLAGS_robust;
  fit.smoothness = FLAGS_smoothness;
  fit.choose_form = ChoosesModel();
  if (!IsDefault("max_parameters")) fit.max_parameters = FLAGS_max_parameters;
  fit.match_reflectance = FLAGS_match_reflectance;
  fit.raw = FLAGS_raw;
  fit.appearance = AppearanceOptionsFromFlags();
  fit.form = FormFromFlags();
  fit.prior = PriorFromFlags();
  fit.seed = static_cast<uint64_t>(FLAGS_seed);
  SolverOptionsFromFlags(solver, ModelSpec());  // its errors
  settings.source = SourceOptionsFromFlags();
  settings.convergence = FLAGS_convergence;
  settings.reconstruction = FLAGS_reconstruction;
  settings.plots = settings.view = FLAGS_plots && !IsDefault("plots");
  settings.key = KeyOfFlags({});
  settings.model_key = KeyOfFlags(kFlagsOfNoModel);
  if (!FLAGS_probe.empty()) settings.inputs.push_back(FLAGS_probe);
  if (init_is_file) {
    fit.start_model = StartFromFile();
    if (!IsMaterial(FLAGS_init)) settings.inputs.push_back(FLAGS_init);
  }
  for (const std::string& input : settings.inputs) {
    const std::string content = ContentHash(ReadFile(input)) + "\n";
    settings.key += content;
    settings.model_key += content;
  }
  return settings;
}

int RunFitOfOne(const std::string& source) {
  FitSettings settings = SettingsFromFlags();
  settings.plots = settings.view = FLAGS_plots;
  if (settings.plots && IsDefault("plots") && !HaveGnuplot()) {
    std::cerr
        << "trilobe: no pictures, as gnuplot is not installed; --noplots is silent about it\n";
    settings.plots = false;
  }
  std::optional<ResultFolder> folder;
  // Who asks for files gets them.
  const bool wants_files = settings.plots || settings.reconstruction || settings.convergence;
  const std::string out = FLAGS_out.empty() && wants_files ? "out/" + FitNameOf(source) : FLAGS_out;
  if (!out.empty()) {
    std::vector<std::string> inputs = settings.inputs;
    inputs.push_back(source);
    folder.emplace(out, FitFileNames(), FitFolderMarks(), Inputs(inputs));
  }
  ResultFolder* const into = folder ? &*folder : nullptr;
  const int threads = ThreadsFromFlags();
  std::optional<InterruptGuard> guard;  // while it reads, Ctrl-C ends it at once
  std::optional<Progress> progress;
  const auto show = [&](const auto& what) {
    if (!progress) progress.emplace(settings.fit.solver_options(ModelSpec()));
    progress->Show(what);
  };
  FitRun run = *RunOneFit(
      source, settings, threads, into, [&] { guard.emplace(); }, show, show);
  progress.reset();
  PrintSummary(run.report);
  if (FLAGS_verbose) PrintDetails(run.report);
  if (!run.earlier.empty()) {
    PrintLine("kept         the earlier model, of " + run.earlier + ", as " + kPreviousModelName);
  }
  std::cout << std::flush;  // drawing takes a while
  if (into == nullptr) {
    PrintSeconds(run.report);
    std::cout << "written      nothing; give --out=DIR to keep the model\n";
  } else {
    const std::string undrawn = WriteOtherFiles(&run, settings, into);
    if (!undrawn.empty()) {
      std::cerr << "trilobe: pictures are missing: " << Printable(undrawn) << "\n";
    }
    PrintSeconds(run.report);
    PrintLine("written      " + Joined(run.report.files) + " in " + out);
  }
  return run.report.interrupted ? 128 + InterruptGuard::signal()
                                : 0;  // as a shell reports such an end
}

// A scene says what is fitted and, by its budgets, what models come out.
int RunFitOfScene(std::span<const std::string> arguments) {
  if (!arguments.empty()) {
    throw Error("--scene names the sources in its file; leave out " + arguments[0]);
  }
  for (const char* const flag :
       {"init",  "model",  "stretch",        "d_nodes",        "f_bins",     "g_nodes",
        "nodes", "prior",  "max_parameters", "robust",         "smoothness", "match_reflectance",
        "raw",   "probe",  "convergence",    "reconstruction", "plots",      "diagnose",
        "shard", "verbose"}) {
    if (!IsDefault(flag)) {
      throw Error("--" + std::string(flag) + " is for the fit of one SOURCE, not for --scene");
    }
  }
  return RunSceneFit(FLAGS_scene);
}

int RunFit(std::span<const std::string> arguments) {
  { const BlasCall memory_is_there; }  // which is better known before the work
  if (!FLAGS_scene.empty()) return RunFitOfScene(arguments);
  if (arguments.empty()) throw Error("trilobe fit needs a SOURCE, or --scene=SCENE");
  for (const char* const flag : {"cache", "nocache"}) {
    if (!IsDefault(flag)) throw Error("--" + std::string(flag) + " goes with --scene");
  }
  std::error_code ignored;
  if (arguments.size() == 1 && IsDefault("shard") &&
      !std::filesystem::is_directory(arguments[0], ignored)) {
    return RunFitOfOne(arguments[0]);
  }
  return RunFitOfMany(arguments, SettingsFromFlags());
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
          "command goes on with the others.\n\nsolvers:\n" +
          ListEntries(Solvers()) + "\nstarting points (--init):\n" + ListEntries(InitialModels()) +
          "\nweightings:\n" + ListEntries(Weightings()) +
          "\n`trilobe help fit --solver=NAME` shows the flags of another solver than this:",
      .flags = FitFlags(),
      .particular_flags = ParticularSolverFlags(),
      .particular_help = [] { return DescribeSolver(SolverFromFlags()); },
      .run = RunFit};
}

}  // namespace trilobe
