#ifndef TRILOBE_FIT_REPORTS_FIT_REPORT_H_
#define TRILOBE_FIT_REPORTS_FIT_REPORT_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fit/reports/verdict_report.h"
#include "trilobe/fit/fit.h"
#include "trilobe/fit/prior/node_choice.h"
#include "trilobe/fit/prior/reach.h"
#include "trilobe/fit/prune/model_choice.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/lobes/lobe_light.h"
#include "trilobe/model/measurement/measurement_stats.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// All that `trilobe fit` has to say about a fit.
struct FitReport {
  // Where the time of the program went [s]; summary.phases tells more of `solve`.
  struct Seconds : FitResult::Seconds {
    double read = 0;
    double draw = 0;  // and write the other files
  };

  FitInfo fit;
  std::string key;                 // what a repetition has in common: FitKey
  std::vector<std::string> files;  // of the run, in its folder
  bool interrupted = false;        // by a signal: the solver, or what comes after it
  ModelSpec spec;
  double noise = 0;                     // of the source
  int64_t seed = 0;                     // of the fit
  int64_t data_seed = 0;                // of what was done to the measurement
  std::vector<std::string> data_notes;  // as in Measurement
  BinCounts bins;                       // of the source: how many were left out, and why
  SolverSummary summary;
  std::optional<NodeChoice> nodes;  // of those of D and G, where it was asked for
  using Prior = FitResult::Prior;
  std::optional<Prior> prior;
  using Finished = FitResult::Finished;
  Finished finished;
  bool raw = false;            // nothing followed the solver (FitOptions::raw)
  double black_objective = 0;  // E of the black model
  int stored_parameters = 0;
  ScoreReport score;
  std::optional<AppearanceReport> appearance;  // none of samples on no grid, which have no picture
  std::optional<SeenError> samples_seen;       // of these
  // Of an isotropic model of anisotropic data: the share of the energy that the mean over all turns
  // of the sample leaves out (AnisotropyOf).
  std::optional<double> left_out;
  std::optional<Reach> reach;  // of scattered samples
  LobeLight light;
  Seconds seconds;
  std::optional<int64_t> peak_memory = std::nullopt;  // of the program [bytes]
};

// What a fit has to say of itself, which is all but the source's part and the program's.
void FillReport(const FitResult& fit, FitReport* report);

// "822 parameters"; of thinned tables not all are stored: the others follow.
std::string ParametersText(const FitReport& report);
// A line that says how large the model is where no sample says so, if that is more than somebody
// would expect.
std::string ReachText(const Reach& reach);

ReportedVerdict VerdictOn(const FitReport& report);

// The verdict, then a few lines that need no knowledge of the method, on standard output.
void PrintSummary(const FitReport& report);

// Where the time went, in parts that sum to the total.
void PrintSeconds(const FitReport& report);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_FIT_REPORT_H_
