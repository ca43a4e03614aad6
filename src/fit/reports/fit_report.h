#ifndef TRILOBE_FIT_REPORTS_FIT_REPORT_H_
#define TRILOBE_FIT_REPORTS_FIT_REPORT_H_

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fit/reports/verdict_report.h"
#include "trilobe/fit/finish/candidate.h"
#include "trilobe/fit/finish/node_choice.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/measurement/measurement_stats.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/lobe_light.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// "format" of report.json.
inline constexpr const char* kReportFormat = "trilobe-report";

// The report of `trilobe fit`; members that FitResult has, too, are explained there.
struct FitReport {
  // Time of each part of the program [s]; summary.phases divides `solve`.
  struct Seconds : FitResult::Seconds {
    double read = 0;
    double draw = 0;  // draws pictures and writes the other files
  };

  FitInfo fit;
  std::string key;                               // FitKey: equal for repetitions of a fit
  std::vector<std::string> files;                // of the run, in its folder
  std::map<std::string, std::string> checksums;  // of those that cannot say who wrote them
  bool interrupted = false;                      // a signal ended the solver or a later step
  ModelSpec spec;
  double noise = 0;                     // of the source
  int64_t seed = 0;                     // of the fit
  int64_t data_seed = 0;                // of changes to the measurement
  std::vector<std::string> data_notes;  // Measurement::notes
  BinCounts bins;                       // of the source
  SolverSummary summary;
  std::optional<AzimuthChoice> azimuths;
  std::optional<NodeChoice> nodes;
  using Prior = FitResult::Prior;
  std::optional<Prior> prior;
  using Finished = FitResult::Finished;
  Finished finished;
  bool raw = false;            // nothing followed the solver (FitOptions::raw)
  double black_objective = 0;  // E of the black model
  int stored_parameters = 0;
  ScoreReport score;
  std::optional<AppearanceReport> appearance;
  std::optional<SeenError> samples_seen;
  std::optional<double> left_out;
  std::optional<Reach> reach;
  double measured_share = 1;  // MeasuredShare
  std::optional<WholeSphere> whole;
  LobeLight light;
  std::optional<BandsFit> bands;
  std::optional<SeenError> bands_seen;
  FitResult::Ripple ripple;
  std::optional<RepeatNoise> repeats;
  std::optional<HeldOutError> held_out;
  std::string processor;  // ProcessorName
  int side_by_side = 1;   // fits that ran at once, each on `threads` of its own
  Seconds seconds;
  std::optional<int64_t> peak_memory = std::nullopt;  // of the program [bytes]
};

// Fills the members that follow from a FitResult.
void FillReport(const FitResult& fit, FitReport* report);

// "822 parameters"; for thinned tables also how many are not stored.
std::string ParametersText(const FitReport& report);
// A line with the largest values of the model where there are no samples, if unexpectedly large.
std::string ReachText(const Reach& reach);

ReportedVerdict VerdictOn(const FitReport& report);

// Prints the verdict and a few lines for readers new to the method on standard output.
void PrintSummary(const FitReport& report);

// Prints the times of the parts, which add up to the total.
void PrintSeconds(const FitReport& report);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_FIT_REPORT_H_
