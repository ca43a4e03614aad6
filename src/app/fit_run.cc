#include "trilobe/app/fit_run.h"

#include <exception>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

#include "trilobe/app/interrupt.h"
#include "trilobe/app/print.h"
#include "trilobe/app/program.h"
#include "trilobe/base/error.h"
#include "trilobe/base/peak_memory.h"
#include "trilobe/base/stopwatch.h"
#include "trilobe/base/utc_time.h"
#include "trilobe/brdf/measurement_stats.h"
#include "trilobe/io/anisotropy.h"
#include "trilobe/io/file.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/node_reconstruction.h"
#include "trilobe/io/picture_data.h"
#include "trilobe/io/plots.h"
#include "trilobe/io/trace_file.h"
#include "trilobe/io/utia_file.h"
#include "trilobe/model/gauge.h"
#include "trilobe/model/reconstruct.h"
#include "trilobe/model/with_axes.h"
#include "trilobe/objective/canonical_form.h"
#include "trilobe/objective/score.h"
#include "trilobe/scene/fit_cache.h"
#include "trilobe/solvers/guide.h"

namespace trilobe {
namespace {

constexpr const char* kModelName = "model.json";
constexpr const char* kTraceName = "trace.csv";
constexpr const char* kReportName = "report.json";
constexpr const char* kCourseName = "course.csv";
constexpr const char* kReconstructionName = "reconstruction.binary";
constexpr const char* kAtNodesName = "reconstruction.bin";
constexpr const char* kPairName = "pair.png";

// On a disk that has filled up meanwhile, a model is saved elsewhere rather than lost.
void WriteModelInto(const ModelFile& file, ResultFolder* folder) {
  const std::string text = FormatModel(file);
  const auto write = [&](std::ostream& out) { out << text; };
  try {
    folder->Write(kModelName, write);
  } catch (const Error& error) {
    std::error_code ignored;
    const std::filesystem::path places[] = {std::filesystem::temp_directory_path(ignored),
                                            std::filesystem::current_path(ignored), "/dev/shm"};
    for (const std::filesystem::path& place : places) {
      const std::string path = place / ("trilobe-" + folder->run() + ".json");
      try {
        WriteFile(path, write);
      } catch (const Error&) {
        continue;
      }
      throw Error(std::string(error.what()) + "; the model is saved as '" + path + "' instead");
    }
    throw;
  }
}

FitInfo InfoOf(const FitSettings& settings, const SolverSummary& summary, const std::string& source,
               const Measurement& measured, const Objective& objective, const std::string& run) {
  return {.solver = settings.solver->name,
          .init = settings.init,
          .weighting = settings.weighting.name,
          .objective = summary.final_objective,
          .initial_objective = summary.initial_objective,
          .stop_reason = StopReasonName(summary.stop_reason),
          .iterations = summary.iterations,
          .seconds = summary.seconds,
          .threads = objective.num_threads(),
          .source = source,
          .valid_samples = objective.samples().size(),
          .max_angle = MaxAngleDegrees(measured),
          .program = ProgramName(),
          .date = UtcNow(),
          .run = run};
}

// An anisotropic model with F in the 90 bins that readers of such files have always found, if those
// have the centres of its own fewer bins among theirs: the same function. All other tables are
// stored as they were fitted.
ModelSpec WithFileBins(ModelSpec spec) {
  constexpr int kFileBins = 90;
  int& bins = spec.f_axis.size;
  if (spec.anisotropic() && kFileBins % bins == 0 && kFileBins / bins % 2 == 1) bins = kFileBins;
  return spec;
}

// Whether a solver had found what it looks for.
bool HasEnded(StopReason reason) {
  return reason == StopReason::kConverged || reason == StopReason::kOptimal ||
         reason == StopReason::kExactFit || reason == StopReason::kNoDecrease;
}

// The model on the axes of this objective, in its canonical form.
FactorModel InForm(const Objective& objective, const FactorModel& model) {
  FactorModel canonical = WithAxes(model, objective.spec());
  Canonicalize(objective, &canonical);
  return canonical;
}

}  // namespace

const std::vector<std::string>& FitFileNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = {kReportName,         kModelName,   kTraceName, kCourseName,
                                    kReconstructionName, kAtNodesName, kPairName};
    all.insert(all.end(), std::begin(kPictureNames), std::end(kPictureNames));
    return all;
  }();
  return names;
}

const std::vector<std::string>& FitFolderMarks() {
  static const std::vector<std::string> marks = {kModelName, kReportName};
  return marks;
}

std::string FitKey(const FitSettings& settings, const std::string& source,
                   const std::string& bytes) {
  std::string text = ProgramName() + "\n" + ProgramBuild() + "\n" + settings.key;
  text += IsSynthetic(source) ? source : ContentHash(bytes);
  return ContentHash(text);
}

std::optional<FitRun> RunOneFit(const std::string& source, const FitSettings& settings,
                                int num_threads, ResultFolder* folder,
                                const std::function<void()>& on_begin,
                                const std::function<void(const IterationRecord&)>& on_iteration) {
  FitReport report;
  report.noise = settings.source.noise;
  report.seed = settings.seed;
  Stopwatch stopwatch;
  SourceOptions source_options = settings.source;
  source_options.num_threads = num_threads;
  Measurement measured;
  if (IsSynthetic(source)) {
    measured = LoadMeasurement(source, source_options);
    report.key = FitKey(settings, source, "");
  } else {
    const std::string bytes = ReadFile(source);
    measured = ParseMeasurement(bytes, source, source_options);
    report.key = FitKey(settings, source, bytes);
  }
  report.seconds.read = stopwatch.Lap();
  TellNotes(measured);
  report.data_notes = measured.notes;
  const BrdfTable* const table = measured.table ? &*measured.table : nullptr;
  if (table == nullptr && settings.finish.max_parameters > 0) {
    throw Error(source +
                ": --model=auto chooses among isotropic models of a MERL or RGL table; choose "
                "--model=isotropic, anisotropic or independent");
  }
  BrdfSamples samples = SamplesOf(measured);
  report.spec = settings.start_model ? settings.start_model->spec() : settings.spec(measured);
  const std::vector<NodeCandidate> ladder =
      settings.start_model ? std::vector<NodeCandidate>() : settings.nodes(report.spec, measured);
  Objective objective(std::move(samples), report.spec, settings.weighting, num_threads);
  const auto interrupted = [] { return InterruptGuard::signal() != 0; };
  report.seconds.prepare = stopwatch.Lap();
  FactorModel model = settings.start_model
                          ? *settings.start_model
                          : settings.start->make(objective, static_cast<uint64_t>(settings.seed));
  report.seconds.init = stopwatch.Lap();
  report.bins = CountsOf(measured);
  if (InterruptGuard::signal() != 0) return std::nullopt;
  if (folder != nullptr) folder->Open();
  on_begin();
  std::optional<UnsavedModel> unsaved;
  if (folder != nullptr) unsaved.emplace();
  if (!ladder.empty()) {
    report.nodes = ChooseNodes(objective, ladder,
                               {.seed = static_cast<uint64_t>(settings.seed),
                                .guide = settings.guide,
                                .on_iteration =
                                    [&](const IterationRecord& record, const FactorModel&) {
                                      on_iteration(record);
                                      return true;
                                    },
                                .stop = interrupted});
    report.spec = report.nodes->tried[report.nodes->chosen].spec;
    objective = Objective(objective, report.spec);
    model = interrupted()
                ? report.nodes->model  // better than a starting point that no solver will improve
                : settings.start->make(objective, static_cast<uint64_t>(settings.seed));
    report.seconds.nodes = stopwatch.Lap();
  }
  Course course;
  SolverOptions options = settings.options(report.spec);
  options.on_iteration = [&](const IterationRecord& record, const FactorModel& current) {
    on_iteration(record);
    if (settings.course) course.Keep(record, current);
    return InterruptGuard::signal() == 0;
  };
  SolverSummary& summary = report.summary;
  std::optional<Objective> guided;
  if (table == nullptr && settings.guide > 0) {
    guided.emplace(WithGuide(objective, {.weight = settings.guide,
                                         .isotropic = !measured.anisotropic,
                                         .stop = interrupted}),
                   report.spec, settings.weighting, num_threads);
    const BrdfSamples& both = guided->samples();
    if (both.size() > objective.samples().size()) {
      report.guide = {both.multiplicity.back(), both.size() - objective.samples().size()};
    }
  }
  const Objective& solved = guided ? *guided : objective;
  summary = settings.solver->make()->Solve(solved, options, &model);
  summary.phases.reading = report.seconds.read;
  report.seconds.solve = stopwatch.Lap();
  report.fit = InfoOf(settings, summary, source, measured, objective,
                      folder == nullptr ? "" : folder->run());
  const ModelSpec file_spec = WithFileBins(report.spec);
  const Objective in_file = file_spec == report.spec ? objective : Objective(objective, file_spec);
  // As the solver left it; what follows may take longer than somebody who ends the program waits.
  if (folder != nullptr && InterruptGuard::signal() == 0) {
    WriteModelInto({InForm(in_file, model), UnobservedParameters(in_file.coverage()), report.fit},
                   folder);
    unsaved.reset();
  }
  FinishOptions finish = settings.finish;
  finish.appearance.num_threads = num_threads;
  finish.stop = interrupted;
  // One that was stopped early gains more by going on.
  finish.match_reflectance = finish.match_reflectance && HasEnded(summary.stop_reason);
  FinishedFit fit = FinishFit(solved, table, std::move(model), finish);
  // Data alone, in the file's bins.
  if (guided || file_spec != report.spec) {
    fit.model = InForm(in_file, fit.model);
    fit.objective = in_file;
  }
  report.finished = {fit.tied, fit.candidates, fit.chosen, fit.matched};
  report.spec = fit.model.spec();
  report.stored_parameters =
      fit.layout.value_or(TableLayout::Full(report.spec)).num_parameters(report.spec);
  report.score = ScoreModel(fit.objective, fit.model);
  report.fit.objective = report.score.objective;
  ModelFile file{fit.model, UnobservedParameters(fit.objective.coverage()), report.fit, fit.layout};
  if (folder != nullptr) WriteModelInto(file, folder);
  unsaved.reset();
  report.seconds.finish = stopwatch.Lap();

  const PictureData pictured = PictureDataOf(measured);
  if (!pictured.empty()) {
    report.appearance = CompareAppearance(pictured, MaterialOf(fit.model), finish.appearance);
  }
  if (measured.anisotropic && !report.spec.anisotropic()) {
    report.left_out = AnisotropyOf(measured).share;
  }
  report.light = ComputeLobeLight(fit.objective.coverage(), fit.model, fit.objective.num_threads());
  report.seconds.score = stopwatch.Lap();
  report.peak_memory = PeakMemory();
  report.interrupted = InterruptGuard::signal() != 0;
  return FitRun{.measured = std::move(measured),
                .objective = std::move(fit.objective),
                .file = std::move(file),
                .report = std::move(report),
                .course = std::move(course)};
}

void WriteRest(FitRun* run, const FitSettings& settings, ResultFolder* folder) {
  const Objective& objective = run->objective;
  const int threads = objective.num_threads();
  FitReport& report = run->report;
  WriteTrace(folder->PathOf(kTraceName), report.summary.trace);
  if (settings.course) run->course.Write(folder->PathOf(kCourseName), objective);
  if (settings.reconstruction) {
    const FactorModel& model = run->file.model;
    const std::string& source = run->file.fit.source;
    if (model.spec().anisotropic()) {
      WriteUtia(ReconstructAtNodes(model, source, kUtiaGrid), folder->PathOf(kAtNodesName));
    } else {
      // A MERL file has one grid, whatever that of the fit was.
      WriteMerl(Reconstruct(model, source, {}, threads), folder->PathOf(kReconstructionName));
    }
  }
  const PictureData pictured =
      settings.pair || settings.plots ? PictureDataOf(run->measured) : PictureData{};
  AppearanceOptions appearance = settings.finish.appearance;
  appearance.num_threads = threads;
  std::exception_ptr failure;
  try {
    if (settings.pair && !pictured.empty()) {
      WriteSpherePair(pictured, MaterialOf(run->file.model), folder->PathOf(kPairName), appearance);
    }
    if (settings.plots) {
      DrawPictures(run->file, pictured, report.summary.trace, folder->path(), appearance);
    }
  } catch (const Error&) {
    failure = std::current_exception();
    report.key.clear();  // not what such a fit leaves
  }
  report.files = folder->Files();
  report.files.emplace_back(kReportName);
  folder->Write(kReportName, [&report](std::ostream& out) {
    out << ToJson(report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  });
  if (failure) std::rethrow_exception(failure);
}

}  // namespace trilobe
