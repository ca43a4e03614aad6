#include <gflags/gflags.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "trilobe/app/command.h"
#include "trilobe/app/flags.h"
#include "trilobe/app/print.h"
#include "trilobe/app/progress.h"
#include "trilobe/base/error.h"
#include "trilobe/io/file.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/plots.h"
#include "trilobe/io/source.h"
#include "trilobe/io/trace_file.h"
#include "trilobe/model/gauge.h"
#include "trilobe/model/reconstruct.h"
#include "trilobe/model/score.h"
#include "trilobe/solvers/initial_model.h"
#include "trilobe/solvers/solver.h"

DEFINE_string(solver, "awls", "one of the solvers below");
DEFINE_string(
    init, "analytic",
    "one of the starting points below, or the path of a model file, whose spec the fit then "
    "takes");
DEFINE_string(model, "shared",
              "shared: D and G shared by the channels, F by the lobes (Peng et al.); independent: "
              "one lobe, nothing shared (Bagher et al.)");
DEFINE_int32(lobes, 3, "specular lobes of --model=shared, 0 to 8");
DEFINE_int32(max_iterations, 60, "stop after this many iterations (for AWLS, sweeps)");
DEFINE_double(max_seconds, 0, "stop after the iteration in which this time is up; 0 for no limit");
DEFINE_double(tolerance, 1e-3, "stop when an iteration changes E by less than this fraction of it");
DEFINE_double(
    g_filter, 0,
    "standard deviation, in degrees, of a Gaussian filter on G after each sweep, which may "
    "raise E; 0 for none");
DEFINE_bool(reconstruction, false, "also write DIR/reconstruction.binary, the fit in MERL layout");
DEFINE_bool(plots, false, "also draw the pictures of `trilobe plot` into DIR");

namespace trilobe {
namespace {

class Stopwatch {
 public:
  // Seconds since construction or the last call.
  double Lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> lap = now - last_;
    last_ = now;
    return lap.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// Where the time of a fit went [s].
struct Phases {
  double read = 0, prepare = 0, init = 0, solve = 0, score = 0;
};

bool IsDefault(const char* flag) { return gflags::GetCommandLineFlagInfoOrDie(flag).is_default; }

SolverOptions SolverOptionsFromFlags(const ModelSpec& spec) {
  if (FLAGS_max_iterations < 0) throw Error("--max_iterations is negative; give 0 or more");
  if (!(FLAGS_max_seconds >= 0)) throw Error("--max_seconds must be a number >= 0; 0 is no limit");
  if (!(FLAGS_tolerance >= 0 && FLAGS_tolerance < 1)) {
    throw Error("--tolerance must be at least 0 and below 1");
  }
  if (!(FLAGS_g_filter >= 0 && FLAGS_g_filter <= 90)) {
    throw Error("--g_filter must be from 0 to 90 degrees");
  }
  SolverOptions options;
  options.max_iterations = FLAGS_max_iterations;
  if (FLAGS_max_seconds > 0) options.max_seconds = FLAGS_max_seconds;
  options.relative_decrease_tolerance = FLAGS_tolerance;
  options.g_filter_sigma = FLAGS_g_filter * spec.g_nodes / 90;
  return options;
}

ModelSpec SpecFromFlags(const MerlGrid& grid) {
  if (FLAGS_model == "independent") {
    if (!IsDefault("lobes") && FLAGS_lobes != 1) {
      throw Error("--model=independent has one lobe; leave out --lobes");
    }
    return ModelSpec::IndependentG(grid);
  }
  if (FLAGS_model != "shared") {
    throw Error("unknown model '" + FLAGS_model + "'; known: shared, independent");
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

std::string UtcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

SolverSummary Solve(const Objective& objective, SolverOptions options, FactorModel* model) {
  const InterruptGuard guard;
  Progress progress(options);
  options.on_iteration = [&progress](const IterationRecord& record, const FactorModel&) {
    progress.Show(record);
    return InterruptGuard::signal() == 0;
  };
  return MakeSolver(FLAGS_solver)->Solve(objective, options, model);
}

// The value of --model that stands for a spec, which a model file may have brought.
std::string ModelName(const ModelSpec& spec) {
  const MerlGrid grid{.theta_h = spec.d_bins, .theta_d = spec.f_bins};
  if (spec == ModelSpec::SharedFactors(spec.lobes, grid)) return "shared";
  if (spec == ModelSpec::IndependentG(grid)) return "independent";
  return "other";
}

nlohmann::ordered_json ReportJson(const FitInfo& fit, const ScoreReport& score,
                                  const ModelSpec& spec, const Phases& phases) {
  return {{"source", fit.source},
          {"valid_samples", fit.valid_samples},
          {"solver", fit.solver},
          {"init", fit.init},
          {"weighting", fit.weighting},
          {"model", ModelName(spec)},
          {"lobes", spec.lobes},
          {"parameters", spec.num_parameters()},
          {"options",
           {{"max_iterations", FLAGS_max_iterations},
            {"max_seconds", FLAGS_max_seconds},
            {"tolerance", FLAGS_tolerance},
            {"g_filter", FLAGS_g_filter},
            {"noise", FLAGS_noise},
            {"seed", FLAGS_seed},
            {"threads", fit.threads}}},
          {"stop_reason", fit.stop_reason},
          {"iterations", fit.iterations},
          {"initial_objective", fit.initial_objective},
          {"objective", score.objective},
          {"relative_objective", score.relative_objective},
          {"psnr_db", score.psnr_db},
          {"psnr_peak", score.psnr_peak},
          {"rmse", score.rmse},
          {"mean_relative_error", score.mean_relative_error},
          {"mean_log_error", score.mean_log_error},
          {"seconds",
           {{"read", phases.read},
            {"prepare", phases.prepare},
            {"init", phases.init},
            {"solve", phases.solve},
            {"score", phases.score}}},
          {"program", fit.program},
          {"date", fit.date}};
}

void PrintReport(const FitInfo& fit, const ScoreReport& score, const ModelSpec& spec,
                 const Phases& phases) {
  std::cout << "source       " << fit.source << ", " << fit.valid_samples << " valid samples\n"
            << "model        " << spec.lobes << " lobes, " << spec.num_parameters()
            << " parameters, weighting " << fit.weighting << "\n"
            << "solver       " << fit.solver << " from " << fit.init << ": " << fit.iterations
            << " iterations, " << fit.stop_reason << "\n"
            << "objective    E " << Text(fit.initial_objective, 6) << " -> "
            << Text(score.objective, 6) << ", " << Text(100 * score.relative_objective)
            << " % of a black model's\n"
            << "error        PSNR " << Text(score.psnr_db) << " dB (peak " << Text(score.psnr_peak)
            << " /sr), RMSE " << Text(score.rmse) << " /sr, mean relative error "
            << Text(100 * score.mean_relative_error) << " %\n"
            << "seconds      " << Text(phases.read, 3) << " read, " << Text(phases.prepare, 3)
            << " prepare, " << Text(phases.init, 3) << " init, " << Text(phases.solve, 3)
            << " solve, " << Text(phases.score, 3) << " score\n";
}

// Everything that a fit leaves in its folder. Each file is written whole or not at all, the model
// first.
void WriteOutputs(const ModelFile& file, const SolverSummary& summary,
                  const nlohmann::ordered_json& report, const BrdfTable& measured, int threads) {
  const std::string folder = FLAGS_out + "/";
  WriteModel(file, folder + "model.json");
  WriteTrace(folder + "trace.csv", summary.trace);
  WriteFile(folder + "report.json", [&report](std::ostream& out) {
    out << report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  });
  std::string written = "model.json, trace.csv, report.json";
  if (FLAGS_reconstruction) {
    WriteMerl(Reconstruct(file.model, file.fit.source, measured.grid, threads),
              folder + "reconstruction.binary");
    written += ", reconstruction.binary";
  }
  if (FLAGS_plots) {
    for (const std::string& path :
         DrawPictures(file, &measured, summary.trace, FLAGS_out, threads)) {
      written += ", " + std::filesystem::path(path).filename().string();
    }
  }
  std::cout << "written      " << written << " in " << FLAGS_out << "\n";
}

int RunFit(std::span<const std::string> arguments) {
  const int threads = ThreadsFromFlags();
  const Weighting& weighting = FindWeighting(FLAGS_weighting);
  MakeSolver(FLAGS_solver);  // a wrong name is said before the long work
  const bool init_is_file = InitIsFile();
  const InitialModel* const init = init_is_file ? nullptr : &FindInitialModel(FLAGS_init);
  SolverOptionsFromFlags(SpecFromFlags({}));
  FactorModel model;
  if (init_is_file) model = StartFromFile({});

  Phases phases;
  Stopwatch stopwatch;
  const BrdfTable measured = LoadSource(arguments[0], SourceOptionsFromFlags());
  phases.read = stopwatch.Lap();
  const ModelSpec spec = init_is_file ? model.spec() : SpecFromFlags(measured.grid);
  const Objective objective(ValidSamples(measured), spec, weighting, threads);
  phases.prepare = stopwatch.Lap();
  if (init != nullptr) model = init->make(objective, static_cast<uint64_t>(FLAGS_seed));
  phases.init = stopwatch.Lap();
  // Now, not later: a fit must not be lost for want of a folder.
  if (!FLAGS_out.empty()) MakeDirectories(FLAGS_out);
  const SolverSummary summary = Solve(objective, SolverOptionsFromFlags(spec), &model);
  phases.solve = stopwatch.Lap();
  Canonicalize(objective.coverage(), &model);
  const ScoreReport score = ScoreModel(objective, model);
  phases.score = stopwatch.Lap();

  const FitInfo fit{.solver = FLAGS_solver,
                    .init = FLAGS_init,
                    .weighting = weighting.name,
                    .objective = score.objective,
                    .initial_objective = summary.initial_objective,
                    .stop_reason = StopReasonName(summary.stop_reason),
                    .iterations = summary.iterations,
                    .seconds = summary.seconds,
                    .threads = threads,
                    .source = arguments[0],
                    .valid_samples = score.valid_samples,
                    .program = std::string("trilobe ") + gflags::VersionString(),
                    .date = UtcNow()};
  PrintReport(fit, score, spec, phases);
  const bool interrupted = summary.stop_reason == StopReason::kInterrupted;
  if (interrupted) std::cout << "interrupted  this is the best model so far\n";
  if (FLAGS_out.empty()) {
    std::cout << "written      nothing; give --out=DIR to keep the model\n";
  } else {
    WriteOutputs({model, DeadParameters(objective.coverage()), fit}, summary,
                 ReportJson(fit, score, spec, phases), measured, threads);
  }
  return interrupted ? 128 + InterruptGuard::signal() : 0;  // as a shell reports such an end
}

// "  name  description" a line, from a registry.
template <typename T>
std::string List(const std::vector<T>& entries) {
  std::string text;
  for (const T& entry : entries) {
    text += "  " + entry.name + std::string(14 - std::min<size_t>(12, entry.name.size()), ' ') +
            entry.description + "\n";
  }
  return text;
}

}  // namespace

Command FitCommand() {
  return {.name = "fit",
          .summary = "fit a model to a measurement",
          .arguments = "SOURCE",
          .min_arguments = 1,
          .max_arguments = 1,
          .details =
              "Writes DIR/model.json (the model, in canonical form), DIR/trace.csv (iteration, "
              "seconds,\nobjective; row 0 is the starting point) and DIR/report.json (settings, "
              "errors, times).\nCtrl-C stops after the iteration and keeps the best model so far; "
              "go on from it with\n--init=DIR/model.json.\n\nsolvers:\n" +
              List(Solvers()) + "\nstarting points (--init):\n" + List(InitialModels()) +
              "\nweightings:\n" + List(Weightings()),
          .flags = {"solver", "init", "weighting", "model", "lobes", "max_iterations",
                    "max_seconds", "tolerance", "g_filter", "threads", "noise", "seed", "out",
                    "reconstruction", "plots"},
          .run = RunFit};
}

}  // namespace trilobe
