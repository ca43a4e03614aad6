#ifndef TRILOBE_APP_PROGRESS_H_
#define TRILOBE_APP_PROGRESS_H_

#include <csignal>

#include "trilobe/model/iteration_record.h"
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

// While one lives, the first SIGINT (Ctrl-C) or SIGTERM does not end the program but is kept in
// signal(); a second one does end it. A signal that the program was started to ignore stays
// ignored.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  static int signal();  // 0 while none has come

 private:
  struct sigaction old_int_ {
  }, old_term_{};
};

}  // namespace trilobe

#endif  // TRILOBE_APP_PROGRESS_H_
