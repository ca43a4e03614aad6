#ifndef TRILOBE_APP_PROGRESS_H_
#define TRILOBE_APP_PROGRESS_H_

#include <cstddef>
#include <string>

#include "core/system/process.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// One line on a terminal that is redrawn as a fit goes on: iteration, E, its relative change, and
// an upper bound on the time left. Draws nothing where standard error is not a terminal.
class Progress {
 public:
  explicit Progress(const SolverOptions& options);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(const IterationRecord& record);

 private:
  const int max_iterations_;
  const double max_seconds_;
  const bool on_terminal_;
  IterationRecord last_;
};

// How many of some jobs are finished, on one line of a terminal: "3 of 100 materials finished, last
// felt, about 5 min left". Draws nothing where standard error is not a terminal.
class JobProgress {
 public:
  JobProgress(size_t count, std::string what);
  ~JobProgress();  // clears the line
  JobProgress(const JobProgress&) = delete;
  JobProgress& operator=(const JobProgress&) = delete;

  // A job is through. What took no time, since it had been done before, says nothing about the
  // rest.
  void Done(const std::string& name, bool took_time = true);
  // Clears the line, to print something else; the next Done draws it again.
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
