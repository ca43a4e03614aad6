#include "app/fit_run.h"

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "app/inputs.h"
#include "app/interrupt.h"
#include "app/program.h"
#include "app/view_page.h"
#include "core/base/file_names.h"
#include "core/base/json_text.h"
#include "core/files/file.h"
#include "core/system/content_hash.h"
#include "core/system/process.h"
#include "fit/reports/bands_report.h"
#include "fit/reports/fit_details.h"
#include "fit/reports/print.h"
#include "io/formats/databases/merl_file.h"
#include "io/formats/databases/utia_file.h"
#include "io/pictures/plots.h"
#include "model/appearance/node_appearance.h"
#include "model/appearance/picture_data.h"
#include "model/measurement/anisotropy.h"
#include "model/measurement/note_symptoms.h"
#include "model/objective/canonical_form.h"
#include "model/objective/gauge.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/fit/finish/synthetic_prior.h"
#include "trilobe/io/formats/trace_file.h"
#include "trilobe/model/measurement/measurement_stats.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/model/objective/score.h"

namespace trilobe {
namespace {

constexpr const char* kModelName = "model.json";
constexpr const char* kSpectralName = "spectral.json";
constexpr const char* kBandsName = "spectral.png";
constexpr const char* kTraceName = "trace.csv";
constexpr const char* kReportName = "report.json";
constexpr const char* kConvergenceName = "convergence.csv";
constexpr const char* kReconstructionName = "reconstruction.binary";
constexpr const char* kAtNodesName = "reconstruction.bin";
constexpr const char* kPairName = "pair.png";
constexpr const char* kViewName = "view.html";

// Writes a model to where there is room, on a disk that has filled up, or where the folder has
// gone, rather than lose it. Returns its path; "" if there is no such place.
std::string SaveElsewhere(const ModelFile& file, const ResultFolder& folder) {
  const std::string text = FormatModel(file);
  std::error_code ignored;
  const std::filesystem::path places[] = {std::filesystem::temp_directory_path(ignored),
                                          std::filesystem::current_path(ignored), "/dev/shm"};
  for (const std::filesystem::path& place : places) {
    std::string path = place / ("trilobe-" + folder.run() + ".json");
    try {
      WriteFile(path, [&](std::ostream& out) { out << text; });
      return path;
    } catch (const Error&) {
      continue;
    }
  }
  return "";
}

void WriteModelInto(const ModelFile& file, ResultFolder* folder) {
  const std::string text = FormatModel(file);
  try {
    folder->Write(kModelName, [&](std::ostream& out) { out << text; });
  } catch (const Error& error) {
    const std::string path = SaveElsewhere(file, *folder);
    if (path.empty()) throw;
    throw error.WithMessage(std::string(error.what()) + "; the model is saved as '" + path +
                            "' instead");
  }
}

// For the end of an Error. Somebody may have removed the folder meanwhile.
std::string WhereModelIs(const ModelFile& file, const ResultFolder& folder) {
  const std::string path = folder.PathOf(kModelName);
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return "; the model is in '" + path + "'";
  const std::string saved = SaveElsewhere(file, folder);
  return saved.empty() ? "" : "; the model is saved as '" + saved + "' instead";
}

// The sentences of advice among what is printed.
std::vector<std::string> AdviceIn(const ReportedVerdict& verdict) {
  constexpr std::string_view kAdvice = "advice ";
  std::vector<std::string> advice;
  std::istringstream lines(Describe(verdict));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(kAdvice)) continue;
    advice.push_back(line.substr(line.find_first_not_of(' ', kAdvice.size())));
  }
  return advice;
}

void WriteView(const FitRun& run, const FitSettings& settings, ResultFolder* folder) {
  const FitReport& report = run.report;
  const ReportedVerdict verdict = VerdictOn(report);
  Compared compared = {.seen = report.samples_seen,
                       .basis = verdict.verdict.basis,
                       .reach = report.reach,
                       .advice = AdviceIn(verdict)};
  if (report.appearance) compared.seen = report.appearance->sphere;
  if (report.bands) compared.wavelengths = WavelengthsText(report.bands->model);
  const ViewedPage page = ViewPage(run.file, run.file.fit.source, &run.measured, compared,
                                   report.summary.trace, settings.fit.appearance);
  folder->Write(kViewName, [&](std::ostream& out) { out << page.text; });
}

// Does the work of WriteOtherFiles, whose errors also say where the model is.
std::string WriteFiles(FitRun* run, const FitSettings& settings, ResultFolder* folder) {
  const int threads = run->objective->num_threads();
  FitReport& report = run->report;
  Stopwatch stopwatch;
  if (report.bands) {
    ModelFile spectral = run->file;
    spectral.spectral = report.bands->model;
    folder->Write(kSpectralName, [&](std::ostream& out) { out << FormatModel(spectral); });
  }
  WriteTrace(folder->PathOf(kTraceName), report.summary.trace);
  if (settings.convergence) {
    run->convergence.Write(folder->PathOf(kConvergenceName), *run->objective);
  }
  run->objective.reset();  // pictures need as much memory
  if (settings.reconstruction) {
    const FactorModel& model = run->file.model;
    const std::string& source = run->file.fit.source;
    const bool at_nodes = model.spec().anisotropic();
    const char* const name = at_nodes ? kAtNodesName : kReconstructionName;
    const BeforeRenaming keep = [&](std::string_view content) {
      folder->KeepChecksum(name, content);
    };
    if (at_nodes) {
      WriteUtia(ReconstructAtNodes(model, source, kUtiaGrid), folder->PathOf(name), keep);
    } else {
      // A MERL file has one grid, whatever that of the fit was.
      WriteMerl(Reconstruct(model, source, {}, threads), folder->PathOf(name), keep);
    }
  }
  const PictureData pictured =
      settings.pair || settings.plots ? PictureDataOf(run->measured) : PictureData{};
  AppearanceOptions appearance = settings.fit.appearance;
  appearance.num_threads = threads;
  std::mutex mutex;
  std::string failure;
  std::vector<std::function<void()>> drawings;
  if (settings.view) drawings.emplace_back([&] { WriteView(*run, settings, folder); });
  if (settings.pair && !pictured.empty()) {
    drawings.emplace_back([&] {
      WriteSpherePair(pictured, MaterialOf(run->file.model), folder->PathOf(kPairName), appearance);
    });
  }
  if (settings.plots) {
    drawings.emplace_back([&] {
      std::optional<SphereError> sphere;
      if (report.appearance) sphere = report.appearance->sphere;
      DrawPictures(run->file, pictured, report.summary.trace, folder->path(), appearance, sphere);
    });
  }
  if (settings.plots && report.bands && report.bands->model.bands() > 1) {
    drawings.emplace_back([&] {
      const SpectralModel& model = report.bands->model;
      std::vector<double> errors;
      for (int l = 0; l < model.bands(); ++l) errors.push_back(report.bands->Relative(l));
      DrawBands(model, errors, FileNameOf(run->file.fit.source) + ": " + WavelengthsText(model),
                folder->PathOf(kBandsName));
    });
  }
  // Users who interrupt the program do not wait for pictures.
  if (report.interrupted) drawings.clear();
  ParallelFor(static_cast<int>(drawings.size()), threads, [&](int k) {
    try {
      drawings[k]();
    } catch (const Error& error) {
      const std::lock_guard<std::mutex> lock(mutex);
      if (failure.empty()) failure = error.what();
    }
  });
  if (!failure.empty()) report.key.clear();  // not what such a fit leaves
  report.files = folder->Files();
  std::erase(report.files, kReportName);  // that of an unfinished run
  report.files.emplace_back(kReportName);
  report.checksums = folder->checksums();
  report.seconds.draw = stopwatch.Lap();
  folder->Write(kReportName,
                [&report](std::ostream& out) { out << JsonText(ToJson(report), 2) << "\n"; });
  return failure;
}

}  // namespace

void ConvergenceCurve::Keep(const IterationRecord& record, const FactorModel& model) {
  // Times the seconds of the one before; and before the first hundredth of a second, none but the
  // start.
  constexpr double kGrowth = 1.5, kFirstSeconds = 0.01;
  last_ = {record, model};
  if (points_.empty() ||
      record.seconds >= std::max(kFirstSeconds, kGrowth * points_.back().record.seconds)) {
    points_.push_back(last_);
  }
}

void ConvergenceCurve::Write(const std::string& path, const Objective& objective) const {
  std::vector<Point> points = points_;
  if (!points.empty() && points.back().record.iteration != last_.record.iteration) {
    points.push_back(last_);
  }
  WriteFile(path, [&](std::ostream& out) {
    out << "iteration,seconds,objective,psnr_db,rmse,mean_relative_error,mean_log_error\n"
        << std::setprecision(std::numeric_limits<double>::max_digits10);
    for (const auto& [record, model] : points) {
      // Objective for the form that was fitted then, which need not be the chosen one.
      const ScoreReport score = ScoreModel(Objective(objective, model.spec()), model);
      out << record.iteration << ',' << record.seconds << ',' << score.objective << ','
          << score.psnr_db << ',' << score.rmse << ',' << score.mean_relative_error << ','
          << score.mean_log_error << '\n';
    }
  });
}

const std::vector<std::string>& FitFileNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = {
        kReportName,      kModelName,          kSpectralName, kBandsName, kTraceName,
        kConvergenceName, kReconstructionName, kAtNodesName,  kPairName,  kViewName};
    all.insert(all.end(), std::begin(kPictureNames), std::end(kPictureNames));
    return all;
  }();
  return names;
}

std::string FitKey(const FitSettings& settings, const Source& source) {
  return ContentHash(ProgramName() + "\n" + ProgramBuild() + "\n" + settings.key +
                     source.Fingerprint());
}

namespace {

// Origin of the model at `path`; "" if there is none, or if this fit makes it again.
std::string WhatEarlierIsOf(const std::string& path, const FitInfo& now) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return "";
  try {
    const FitInfo earlier = ReadModel(path).fit;
    if (earlier.key == now.key) return "";
    if (FileNameOf(earlier.source) != FileNameOf(now.source)) return FileNameOf(earlier.source);
    if (earlier.source_xxh128 != now.source_xxh128) return "an earlier state of the measurement";
    return earlier.program == now.program ? "other flags" : earlier.program;
  } catch (const Error&) {
    return "who knows what";  // but not ours to lose
  }
}

}  // namespace

std::optional<FitRun> RunOneFit(const std::string& source, const FitSettings& settings,
                                int num_threads, ResultFolder* folder,
                                const std::function<void()>& on_begin,
                                const std::function<void(const IterationRecord&)>& on_iteration,
                                const std::function<void(const StartProgress&)>& on_start) {
  FitReport report;
  report.noise = settings.source.noise;
  report.seed = static_cast<int64_t>(settings.fit.seed);
  report.processor = ProcessorName();
  report.side_by_side = settings.side_by_side;
  report.data_seed = static_cast<int64_t>(settings.source.seed);
  Stopwatch stopwatch;
  SourceOptions source_options = settings.source;
  source_options.num_threads = num_threads;
  RefuseMaterial(source);
  Measurement measured;
  std::string model_key;
  {
    const Source input(source);
    measured = input.Read(source_options);
    report.key = FitKey(settings, input);
    model_key = ContentHash(ProgramName() + "\n" + settings.model_key + input.Fingerprint());
  }
  if (InterruptGuard::signal() != 0) return std::nullopt;
  report.seconds.read = stopwatch.Lap();
  NoteSymptoms(num_threads, &measured);
  if (settings.tell_notes) PrintNotes(measured);
  report.data_notes = measured.notes;
  report.bins = CountsOf(measured);
  const std::string run = folder == nullptr ? "" : folder->run();
  const auto file_of = [&](const FitResult& fit) {
    ModelFile file = fit.file;
    file.fit.source = source;
    file.fit.program = ProgramName();
    file.fit.date = UtcNow();
    file.fit.run = run;
    file.fit.key = model_key;
    return file;
  };
  std::string earlier;
  if (folder != nullptr) {
    FitInfo now;
    now.source = source;
    now.source_xxh128 = measured.xxh128;
    now.program = ProgramName();
    now.key = model_key;
    earlier = WhatEarlierIsOf(folder->PathOf(kModelName), now);
    if (!earlier.empty()) folder->KeepEarlier(kModelName);
  }
  bool begun = false;
  std::optional<UnsavedModel> unsaved;
  ConvergenceCurve convergence;
  FitOptions options = settings.fit;
  options.num_threads = num_threads;
  options.stop = [] { return InterruptGuard::signal() != 0; };
  options.on_begin = [&] {
    begun = true;
    if (folder != nullptr) folder->Open();
    on_begin();
    if (folder != nullptr) unsaved.emplace();
  };
  options.on_progress = on_iteration;
  options.on_start = on_start;
  options.on_iteration = [&](const IterationRecord& record, const FactorModel& model) {
    if (settings.convergence) convergence.Keep(record, model);
  };
  options.on_model = [&](const FitResult& fit) {
    if (folder != nullptr) WriteModelInto(file_of(fit), folder);
    unsaved.reset();
  };
  FitResult fit = Fit(measured, options);
  if (!begun) return std::nullopt;
  ModelFile file = file_of(fit);
  report.fit = file.fit;
  FillReport(fit, &report);
  report.summary.phases.reading = report.seconds.read;
  report.peak_memory = PeakMemory();
  return FitRun{.measured = std::move(measured),
                .objective = std::move(fit.objective),
                .file = std::move(file),
                .report = std::move(report),
                .convergence = std::move(convergence),
                .earlier = std::move(earlier)};
}

std::string WriteOtherFiles(FitRun* run, const FitSettings& settings, ResultFolder* folder) {
  try {
    return WriteFiles(run, settings, folder);
  } catch (const Error& error) {
    throw error.WithMessage(error.what() + WhereModelIs(run->file, *folder));
  }
}

}  // namespace trilobe
