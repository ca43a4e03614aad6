#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "trilobe/app/appearance_report.h"
#include "trilobe/app/command.h"
#include "trilobe/app/course.h"
#include "trilobe/app/finish_fit.h"
#include "trilobe/app/fit_report.h"
#include "trilobe/app/flags.h"
#include "trilobe/app/progress.h"
#include "trilobe/app/scene_run.h"
#include "trilobe/app/solver_flags.h"
#include "trilobe/base/error.h"
#include "trilobe/base/peak_memory.h"
#include "trilobe/base/stopwatch.h"
#include "trilobe/base/utc_time.h"
#include "trilobe/io/file.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/plots.h"
#include "trilobe/io/source.h"
#include "trilobe/io/trace_file.h"
#include "trilobe/model/continuous_model.h"
#include "trilobe/model/gauge.h"
#include "trilobe/model/measurement_stats.h"
#include "trilobe/model/reconstruct.h"
#include "trilobe/model/score.h"
#include "trilobe/solvers/initial_model.h"
#include "trilobe/solvers/solver.h"

DEFINE_string(
    init, "analytic",
    "one of the starting points above, or the path of a model file, whose spec the fit then "
    "takes");
DEFINE_string(
    model, "shared",
    "shared: D and G shared by the channels, F by the lobes (Peng et al.); independent: "
    "one lobe, nothing shared (Bagher et al.); auto: what looks best within --max_numbers "
    "(docs/model-choice.md)");
DEFINE_int32(max_numbers, 822, "with --model=auto: how many numbers the model may store");
DEFINE_double(
    robust, 0,
    "go on with a loss that is linear in the error, as the weighting sees it, beyond this, "
    "by reweighting; 0 for none");
DEFINE_string(scene, "", "scene file (docs/scene.md): fit its materials, instead of a SOURCE");
DEFINE_bool(reconstruction, false, "also write DIR/reconstruction.binary, the fit in MERL layout");
DEFINE_bool(
    course, false,
    "also write DIR/course.csv: errors of the models on the way, scored when the fit is over");
DEFINE_bool(plots, false, "also draw the pictures of `trilobe plot` into DIR");

namespace trilobe {
namespace {

FinishOptions FinishOptionsFromFlags() {
  if (!(FLAGS_robust >= 0 && FLAGS_robust <= 1e6)) throw Error("--robust must be from 0 to 1e6");
  if (FLAGS_max_numbers < 1) throw Error("--max_numbers must be at least 1");
  if (FLAGS_model != "auto" && !IsDefault("max_numbers")) {
    throw Error("--max_numbers goes with --model=auto");
  }
  return {.robust = FLAGS_robust,
          .max_numbers = FLAGS_model == "auto" ? FLAGS_max_numbers : 0,
          .appearance = AppearanceOptionsFromFlags()};
}

ModelSpec SpecFromFlags(const MerlGrid& grid) {
  if (FLAGS_model == "independent") {
    if (!IsDefault("lobes") && FLAGS_lobes != 1) {
      throw Error("--model=independent has one lobe; leave out --lobes");
    }
    return ModelSpec::IndependentG(grid);
  }
  if (FLAGS_model != "shared" && FLAGS_model != "auto") {
    throw Error("unknown model '" + FLAGS_model + "'; known: shared, independent, auto");
  }
  const ModelSpec spec = ModelSpec::SharedFactors(FLAGS_lobes, grid);
  CheckSpec(spec);
  return spec;
}

// The starting point is a file where --init is not a name but something like a path.
bool InitIsFile() {
  for (const InitialModel& init : InitialModels()) {
    if (init.name == FLAGS_init) return false;
  }
  std::error_code ignored;
  return FLAGS_init.find('/') != std::string::npos || FLAGS_init.ends_with(".json") ||
         std::filesystem::exists(FLAGS_init, ignored);
}

FactorModel StartFromFile(const MerlGrid& grid) {
  FactorModel model = ReadModel(FLAGS_init).model;
  const ModelSpec& spec = model.spec();
  if ((!IsDefault("lobes") || !IsDefault("model")) && !(spec == SpecFromFlags(grid))) {
    throw Error(FLAGS_init +
                " does not have the lobes and sharing that --lobes and --model ask "
                "for; leave these flags out to fit the file's own");
  }
  return model;
}

SolverSummary Solve(const SolverEntry& solver, const Objective& objective, SolverOptions options,
                    FactorModel* model, Course* course) {
  Progress progress(options);
  options.on_iteration = [&](const IterationRecord& record, const FactorModel& current) {
    progress.Show(record);
    if (FLAGS_course) course->Keep(record, current);
    return InterruptGuard::signal() == 0;
  };
  return solver.make()->Solve(objective, options, model);
}

// Everything that a fit leaves in its folder. Each file is written whole or not at all, the model
// first.
void WriteOutputs(const ModelFile& file, const FitReport& report, const BrdfTable& measured,
                  const Course& course, const Objective& objective) {
  const std::string folder = FLAGS_out + "/";
  WriteModel(file, folder + "model.json");
  WriteTrace(folder + "trace.csv", report.summary.trace);
  WriteFile(folder + "report.json", [&report](std::ostream& out) {
    out << ToJson(report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  });
  std::string written = "model.json, trace.csv, report.json";
  if (FLAGS_course) {
    course.Write(folder + "course.csv", objective);
    written += ", course.csv";
  }
  const int threads = objective.num_threads();
  if (FLAGS_reconstruction) {
    WriteMerl(Reconstruct(file.model, file.fit.source, measured.grid, threads),
              folder + "reconstruction.binary");
    written += ", reconstruction.binary";
  }
  if (FLAGS_plots) {
    for (const std::string& path : DrawPictures(file, &measured, report.summary.trace, FLAGS_out,
                                                AppearanceOptionsFromFlags())) {
      written += ", " + std::filesystem::path(path).filename().string();
    }
  }
  std::cout << "written      " << written << " in " << FLAGS_out << "\n";
}

// A scene says what is fitted and, by its budgets, what models come out.
int RunFitOfScene(std::span<const std::string> arguments) {
  if (!arguments.empty()) {
    throw Error("--scene names the sources in its file; leave out " + arguments[0]);
  }
  for (const char* const flag : {"init", "model", "max_numbers", "robust", "probe", "course",
                                 "reconstruction", "plots", "diagnose"}) {
    if (!IsDefault(flag)) {
      throw Error("--" + std::string(flag) + " is for the fit of one SOURCE, not for --scene");
    }
  }
  return RunSceneFit(FLAGS_scene);
}

int RunFit(std::span<const std::string> arguments) {
  if (!FLAGS_scene.empty()) return RunFitOfScene(arguments);
  if (arguments.empty()) throw Error("trilobe fit needs a SOURCE, or --scene=SCENE");
  for (const char* const flag : {"cache", "nocache"}) {
    if (!IsDefault(flag)) throw Error("--" + std::string(flag) + " goes with --scene");
  }
  const int threads = ThreadsFromFlags();
  const Weighting weighting = FindWeighting(FLAGS_weighting);
  const SolverEntry& solver = SolverFromFlags();
  const bool init_is_file = InitIsFile();
  const InitialModel* const init = init_is_file ? nullptr : &FindInitialModel(FLAGS_init);
  // Before the long work, for the errors.
  FinishOptions finish = FinishOptionsFromFlags();
  finish.stop = [] { return InterruptGuard::signal() != 0; };
  SolverOptionsFromFlags(solver, SpecFromFlags({}));
  const SourceOptions source_options = SourceOptionsFromFlags();
  FactorModel model;
  if (init_is_file) model = StartFromFile({});

  FitReport report;
  report.noise = FLAGS_noise;
  report.seed = FLAGS_seed;
  Stopwatch stopwatch;
  const BrdfTable measured = LoadSource(arguments[0], source_options);
  report.seconds.read = stopwatch.Lap();
  report.spec = init_is_file ? model.spec() : SpecFromFlags(measured.grid);
  const Objective objective(ValidSamples(measured), report.spec, weighting, threads);
  report.seconds.prepare = stopwatch.Lap();
  if (init != nullptr) model = init->make(objective, static_cast<uint64_t>(FLAGS_seed));
  report.seconds.init = stopwatch.Lap();
  report.bins = CountBins(measured);
  // Now, not later: a fit must not be lost for want of a folder.
  if (!FLAGS_out.empty()) MakeDirectories(FLAGS_out);
  // From here on a first Ctrl-C ends the work but not before the model is written.
  const InterruptGuard guard;
  Course course;
  SolverSummary& summary = report.summary;
  summary = Solve(solver, objective, SolverOptionsFromFlags(solver, report.spec), &model, &course);
  summary.phases.reading = report.seconds.read;
  report.seconds.solve = stopwatch.Lap();
  const FinishedFit fit = FinishFit(objective, measured, std::move(model), finish);
  report.finished = {fit.tied, fit.candidates, fit.chosen};
  report.spec = fit.model.spec();
  report.stored_numbers =
      fit.layout ? fit.layout->num_numbers(report.spec) : report.spec.num_parameters();
  report.seconds.finish = stopwatch.Lap();
  report.score = ScoreModel(fit.objective, fit.model);
  report.appearance = CompareAppearance(measured, ContinuousModel(fit.model), finish.appearance);
  report.light = ComputeLobeLight(fit.objective.coverage(), fit.model);
  report.seconds.score = stopwatch.Lap();
  report.peak_memory = PeakMemory();

  report.fit = {.solver = solver.name,
                .init = FLAGS_init,
                .weighting = weighting.name,
                .objective = report.score.objective,
                .initial_objective = summary.initial_objective,
                .stop_reason = StopReasonName(summary.stop_reason),
                .iterations = summary.iterations,
                .seconds = summary.seconds,
                .threads = threads,
                .source = arguments[0],
                .valid_samples = report.score.valid_samples,
                .max_angle = MaxAngleDegrees(measured),
                .program = std::string("trilobe ") + gflags::VersionString(),
                .date = UtcNow()};
  Print(report);
  const bool interrupted = InterruptGuard::signal() != 0;
  if (interrupted) std::cout << "interrupted  this is the best model so far\n";
  if (FLAGS_out.empty()) {
    std::cout << "written      nothing; give --out=DIR to keep the model\n";
  } else {
    WriteOutputs({fit.model, DeadParameters(fit.objective.coverage()), report.fit, fit.layout},
                 report, measured, course, fit.objective);
  }
  return interrupted ? 128 + InterruptGuard::signal() : 0;  // as a shell reports such an end
}

// "  name  description" a line, from a registry.
template <typename T>
std::string List(const std::vector<T>& entries) {
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
  std::vector<std::string> flags = {"solver", "init",        "weighting", "model",
                                    "robust", "max_numbers", "lobes"};
  for (const std::string& flag : CommonSolverFlags()) flags.push_back(flag);
  flags.insert(flags.end(),
               {"threads", "noise", "seed", "max_angle", "extrapolated", "out", "reconstruction",
                "course", "plots", "probe", "scene", "cache", "nocache"});
  return {.name = "fit",
          .summary = "fit a model to a measurement",
          .arguments = "SOURCE | --scene=SCENE",
          .min_arguments = 0,
          .max_arguments = 1,
          .details =
              "Writes DIR/model.json (the model, in canonical form), DIR/trace.csv (E, step and "
              "seconds of\neach iteration; row 0 is the starting point) and DIR/report.json "
              "(settings, errors, diagnosis,\ntimes). Ctrl-C stops after the iteration and keeps "
              "the best model so far; go on from it, with the\nsame solver or another, with "
              "--init=DIR/model.json.\n\nWith --scene, does what `trilobe plan` says for the "
              "materials of a scene file, side by side, and\nwrites DIR/NAME.json (a model) for "
              "each, DIR/plan.json and DIR/plan.txt. Ctrl-C keeps what is\nfinished; the same "
              "command goes on with the others.\n\nsolvers:\n" +
              List(Solvers()) + "\nstarting points (--init):\n" + List(InitialModels()) +
              "\nweightings:\n" + List(Weightings()) +
              "\n`trilobe help fit --solver=NAME` shows the flags of another solver than this:",
          .flags = flags,
          .particular_flags = ParticularSolverFlags(),
          .particular_help = [] { return DescribeSolver(SolverFromFlags()); },
          .run = RunFit};
}

}  // namespace trilobe
