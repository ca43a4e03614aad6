#ifndef TRILOBE_APP_PROGRESS_H_
#define TRILOBE_APP_PROGRESS_H_

#include <cstddef>
#include <string>

#include "core/system/process.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// Progress of a solver in the line of Status: iteration, E, its relative change, or while starts
// are tried how many have been, and an upper bound on the time left. A start that is at its end has
// a line of its own, which stays, also in a file if `verbose`.
class Progress {
 public:
  Progress(const SolverOptions& options, bool verbose);

  void Show(const IterationRecord& record);
  // Shows how many starts of a round have ended. From any thread, one call at a time.
  void Show(const StartProgress& starts) const;

 private:
  const int max_iterations_;
  const double max_seconds_;
  const bool verbose_;
  const Stopwatch since_;
  IterationRecord last_;
};

// Number of finished jobs as a stage of Status: "3 of 100 materials finished, last felt, about 5
// min left".
class JobProgress {
 public:
  JobProgress(size_t count, std::string what);
  ~JobProgress();  // ends the stage
  JobProgress(const JobProgress&) = delete;
  JobProgress& operator=(const JobProgress&) = delete;

  // Counts a finished job. Reused results (took_time false) do not count for the time left.
  void Done(const std::string& name, bool took_time = true);

 private:
  void Show() const;

  const size_t count_;
  const std::string what_;
  const Stopwatch since_;
  size_t done_ = 0, timed_ = 0;
  std::string last_;
};

}  // namespace trilobe

#endif  // TRILOBE_APP_PROGRESS_H_
