#ifndef TRILOBE_APP_PROGRESS_H_
#define TRILOBE_APP_PROGRESS_H_

#include <cstddef>
#include <string>

#include "core/system/process.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// Progress of a fit on one line of a terminal: iteration, E, its relative change, or while starts
// are tried how many have been, and an upper bound on the time left. Draws nothing if standard
// error is not a terminal. A start that is at its end has a line of its own, which stays, also in a
// file if `verbose`.
class Progress {
 public:
  Progress(const SolverOptions& options, bool verbose);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(const IterationRecord& record);
  // Shows how many starts of a round have ended. From any thread, one call at a time.
  void Show(const StartProgress& starts) const;

 private:
  const int max_iterations_;
  const double max_seconds_;
  const bool on_terminal_, verbose_;
  const Stopwatch since_;
  IterationRecord last_;
};

// Number of finished jobs on one line of a terminal: "3 of 100 materials finished, last felt, about
// 5 min left". Draws nothing if standard error is not a terminal.
class JobProgress {
 public:
  JobProgress(size_t count, std::string what);
  ~JobProgress();  // clears the line
  JobProgress(const JobProgress&) = delete;
  JobProgress& operator=(const JobProgress&) = delete;

  // Counts a finished job. Reused results (took_time false) do not count for the time left.
  void Done(const std::string& name, bool took_time = true);
  // Clears the line until the next Done.
  void Clear() const;

 private:
  void Show() const;

  const bool on_terminal_;
  const size_t count_;
  const std::string what_;
  const Stopwatch since_;
  size_t done_ = 0, timed_ = 0;
  std::string last_;
};

}  // namespace trilobe

#endif  // TRILOBE_APP_PROGRESS_H_
