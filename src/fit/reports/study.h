#ifndef TRILOBE_FIT_REPORTS_STUDY_H_
#define TRILOBE_FIT_REPORTS_STUDY_H_

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "model/objective/lobe_match.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/read_model.h"

// A study solves the same problems by several methods from the same starting points, to compare the
// methods. A problem is an objective: a measurement with its weighting. A method is a solver with
// its options. E is what the methods minimise, with the prior where there is one.

namespace trilobe {

// One fit.
struct StudyRun {
  std::string problem, method;
  int start = 1;           // 1: the given one; the others are random
  std::string folder;      // of its files, within that of the study
  std::string error = {};  // why there is no result; then nothing below is set

  std::string stop_reason = {};  // StopReasonName
  double seconds = 0;            // from preparing the objective to the end of the solver
  int samples = 0, parameters = 0;
  std::string weighting = {};
  // The scaled gradient where it stopped (Diagnosis::optimality), if it was computed.
  std::optional<double> optimality = {};
  // E of the data over a black model's, and what noise alone leaves of it, as far as samples repeat
  // (RepeatNoise).
  std::optional<double> relative_E = {}, noise_E = {};
  // Beside the measurement: of the sphere or, where the samples form none, of the samples.
  std::optional<double> psnr_db = {}, mean_delta_e = {};
  bool of_sphere = true;
  bool seen = true;  // false: cannot be told apart from the measurement
  // The error at held-out directions of the same fit without these (HeldOutError).
  std::optional<double> held_out_E = {}, held_out_delta_e = {};
  // When and where it was made, and beside how many others.
  std::string date = {}, processor = {};
  int side_by_side = 1;
  std::vector<IterationRecord> trace = {};  // seconds as above, since the objective was prepared
  ModelFile file = {};

  // Set by CompareRuns: the lowest E of the problem's runs, and what an excess over it is relative
  // to.
  double lowest = 0, unit = 1;
  // Match with the lobes of the problem's lowest run and of the method's own, unless these cannot
  // be compared, are none, or are this run's.
  std::optional<LobeMatch> lobes = {}, own_lobes = {};

  bool failed() const { return !error.empty(); }
  double objective() const;  // the lowest E of its trace; infinite if it failed
  double ExcessOf(double E) const { return (E - lowest) / unit; }
  double excess() const { return ExcessOf(objective()); }
  int iterations() const;
  bool reached_limit() const;  // of iterations or time: E might fall further
  // Agreement of its lobes with those of the problem's lowest run.
  std::optional<double> agreement() const;
  // Seconds until E has at most this excess; infinite if it never has.
  double SecondsTo(double most_excess) const;
};

// Below this excess a run has found the lowest E for all purposes, and below the other to the
// digits that are printed.
inline constexpr double kAsGood = 0.01, kTheSame = 0.001;
// Lobes are the same where their agreement is at least this.
inline constexpr double kSameLobes = 0.9;

// Compares each run with the lowest of its problem. An excess is relative to the lowest E. Where
// that is below 1e-12 of the highest initial E, as of data without noise, it is relative to this.
void CompareRuns(std::vector<StudyRun>* runs);

// Copies of the runs on a problem.
std::vector<StudyRun> RunsOn(const std::string& problem, std::span<const StudyRun> runs);

// The run of the lowest E of a problem; null if all have failed.
const StudyRun* LowestRun(std::span<const StudyRun> runs, const std::string& problem);

// A share of n runs, with the 95 % interval of the binomial (Wilson 1927).
struct Share {
  int count = 0, of = 0;
  double value() const { return of > 0 ? static_cast<double>(count) / of : 0; }
  double low() const;
  double high() const;
};

// Wilson's 95 % interval of a share of n, which need not be a whole number of these.
struct Interval {
  double low = 0, high = 1;
};
Interval WilsonInterval(double share, int n);

// Figures of the runs of one method on one problem. A failed run counts as infinite, and
// so does a median if half of the runs are.
struct MethodSummary {
  std::string problem, method;
  int runs = 0, failed = 0;
  double lowest = 0, median = 0, highest = 0;  // excess
  Share as_good = {}, the_same = {};           // excess at most kAsGood, kTheSame
  double seconds = 0;                          // median of a whole run
  double seconds_to_as_good = 0;               // median
  // Seconds until restarts have found E within kAsGood of the lowest, in expectation: the mean time
  // of a run divided by the share of those that do. Infinite if none does. What a failed run took
  // is not known and counts as 0.
  double expected_seconds = 0;
  double iterations = 0;  // median
  // Why runs ended (StopReasonName), and how many; in the order of their first runs.
  std::vector<std::pair<std::string, int>> endings = {};
  // A limit stopped one of those that have not come within kAsGood of the lowest E.
  bool short_of_limit = false;
  int parameters = 0;  // of the first run with a model
  // Iterations of all runs, and those that raised E (SolverSummary::FindRaises).
  int all_iterations = 0, raised = 0;
  double largest_rise = 0;
  std::optional<double> relative_E = {}, optimality = {};        // median and largest
  std::optional<double> held_out_E = {}, held_out_delta_e = {};  // medians
  std::optional<double> psnr_db = {}, mean_delta_e = {};         // medians
  Share unseen = {};  // models that cannot be told apart from the measurement
  // Other runs whose lobes are those of the problem's lowest run, and of the method's own.
  Share same_lobes = {}, same_as_own = {};
  std::optional<double> agreement = {};  // median, with the lobes of the problem's lowest run
};

// One for each problem and method, in the order of their first runs.
std::vector<MethodSummary> SummariesOf(std::span<const StudyRun> runs);

// The time that median runs of a method take until E is within kAsGood of the lowest, over
// problems.
struct Times {
  int reached = 0, of = 0;      // problems
  double geometric_mean = 0;    // of those reached [s]
  bool short_of_limit = false;  // on one that was not
};
Times TimesOf(std::span<const MethodSummary> summaries, const std::string& method);

// The names of problems and methods, in the order of their first runs.
std::vector<std::string> ProblemsOf(std::span<const StudyRun> runs);
std::vector<std::string> MethodsOf(std::span<const StudyRun> runs);

// "stopped by --max_seconds", "converged"; of a StopReasonName.
std::string EndingWords(const std::string& reason);

// Text such as "10 of 10 stopped by --max_iterations", or "3 of 5 converged, 2 of 5 stopped by
// --max_seconds".
std::string EndingsText(const MethodSummary& of);

// Says in sentences what the runs show: who found the lowest E, how often, how soon; who was
// stopped by a limit; who raised E; whether the lobes are the same; what predicts held-out samples;
// what is seen.
std::vector<std::string> VerdictOn(std::span<const StudyRun> runs);

// Tables as CSV, with a header line (docs/study.md). Infinite values are "inf".
std::string RunsCsv(std::span<const StudyRun> runs);
std::string MethodsCsv(std::span<const MethodSummary> summaries);
std::string TracesCsv(std::span<const StudyRun> runs);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_STUDY_H_
