#ifndef TRILOBE_APP_FIT_RUN_H_
#define TRILOBE_APP_FIT_RUN_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/result_folder.h"
#include "fit/reports/fit_report.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// How a fit's errors go down with time, measured without delaying the fit: it keeps copies of
// models at seconds that grow by a constant factor, and scores them when the fit is over.
class ConvergenceCurve {
 public:
  // The first model, and each that comes when enough time has gone by since the one before.
  void Keep(const IterationRecord& record, const FactorModel& model);

  // Writes convergence.csv (docs/file-formats.md): those kept, and the last model of the fit.
  void Write(const std::string& path, const Objective& objective) const;

 private:
  struct Point {
    IterationRecord record;
    FactorModel model;
  };
  std::vector<Point> points_;
  Point last_;
};

// How `trilobe fit` fits, whatever it is given.
struct FitSettings {
  FitOptions fit;  // its threads and callbacks are replaced
  SourceOptions source;
  // What is written besides model.json, trace.csv and report.json: files of these names.
  bool convergence = false, reconstruction = false, plots = false;
  bool pair = false;                // pair.png, a thumbnail
  bool view = false;                // view.html, a page
  std::vector<std::string> inputs;  // files that all fits read
  std::string key;                  // all of this but the measurement, files by their content
};

// Names of all files that a fit may leave in its folder.
const std::vector<std::string>& FitFileNames();

// Of these every such folder has one.
const std::vector<std::string>& FitFolderMarks();

// What the result depends on: settings, the measurement's content, the program's version.
// 32 hexadecimal digits.
std::string FitKey(const FitSettings& settings, const Source& source);

// A fit that is through, and in its folder if it has one, as far as the model goes.
struct FitRun {
  Measurement measured;
  Objective objective;
  ModelFile file;
  FitReport report;
  ConvergenceCurve convergence;
};

// Reads a measurement, fits it, writes the model into `folder` (none if null), and only then scores
// it. A signal ends it early, with the best model so far, or with nothing while it reads.
// `on_begin` is called when it has read all and there begins to be something to lose; an
// InterruptGuard must live from then on. Throws Error.
std::optional<FitRun> RunOneFit(const std::string& source, const FitSettings& settings,
                                int num_threads, ResultFolder* folder,
                                const std::function<void()>& on_begin,
                                const std::function<void(const IterationRecord&)>& on_iteration);

// Writes the other files, the report last: where it is, all are but pictures that could not be
// drawn. Returns why these could not; "" if all are there. Throws Error for other files,
// which says where the model is.
std::string WriteOtherFiles(FitRun* run, const FitSettings& settings, ResultFolder* folder);

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_RUN_H_
