#ifndef TRILOBE_APP_FIT_RUN_H_
#define TRILOBE_APP_FIT_RUN_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/result_folder.h"
#include "fit/reports/fit_report.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Errors of a fit over time, measured without delaying the fit: copies models at times that grow by
// a constant factor, and scores the copies after the fit.
class ConvergenceCurve {
 public:
  // Keeps the first model, and each that comes long enough after the last one kept.
  void Keep(const IterationRecord& record, const FactorModel& model);

  // Writes convergence.csv (docs/file-formats.md): the kept models and the last model.
  void Write(const std::string& path, const Objective& objective) const;

 private:
  struct Point {
    IterationRecord record;
    FactorModel model;
  };
  std::vector<Point> points_;
  Point last_;
};

// Settings of `trilobe fit` that are the same for all of its measurements.
struct FitSettings {
  FitOptions fit;  // num_threads and callbacks are replaced
  SourceOptions source;
  // Files to write besides model.json, trace.csv and report.json.
  bool convergence = false, reconstruction = false, plots = false;
  bool pair = false;                // pair.png, a thumbnail
  bool view = false;                // view.html, a page
  int side_by_side = 1;             // fits that run at once, for the report
  bool tell_notes = true;           // print what was noticed of the measurement
  std::vector<std::string> inputs;  // files that all fits read
  std::string key;                  // encodes these settings, with input files by their content
  std::string model_key;            // the same of those on which a model depends
};

// Names of all files that a fit may write into its folder.
const std::vector<std::string>& FitFileNames();

// Hash of everything that the result depends on: settings, content of the measurement, version of
// the program. 32 hexadecimal digits.
std::string FitKey(const FitSettings& settings, const Source& source);

// A finished fit, whose model has been written if there is a folder.
struct FitRun {
  Measurement measured;
  std::optional<Objective> objective;  // none once its figures are in the report
  ModelFile file;
  FitReport report;
  ConvergenceCurve convergence;
  // Origin of the folder's earlier model, if it is another one: it is kept (kPreviousModelName).
  std::string earlier = {};
};

inline constexpr const char* kPreviousModelName = "model.previous.json";

// Reads and fits a measurement, writes the model into `folder` (unless null), then scores it. A
// signal ends the fit early with the best model so far; while reading, nothing is returned.
// `on_begin` is called after reading; from then on an InterruptGuard must exist. Throws Error.
std::optional<FitRun> RunOneFit(const std::string& source, const FitSettings& settings,
                                int num_threads, ResultFolder* folder,
                                const std::function<void()>& on_begin,
                                const std::function<void(const IterationRecord&)>& on_iteration,
                                const std::function<void(const StartProgress&)>& on_start);

// Writes the other files. The report is last, so its presence means that all are written except
// pictures that could not be drawn. Returns why these could not; empty if all are there. Throws
// Error, which says where the model is, if another file cannot be written.
std::string WriteOtherFiles(FitRun* run, const FitSettings& settings, ResultFolder* folder);

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_RUN_H_
