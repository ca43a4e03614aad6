#ifndef TRILOBE_SOLVERS_RUN_H_
#define TRILOBE_SOLVERS_RUN_H_

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "trilobe/solvers/solver.h"

namespace trilobe {

// Adds the time of its own life to a phase.
class ScopedTimer {
 public:
  explicit ScopedTimer(double* seconds) : seconds_(seconds) {}
  ~ScopedTimer() {
    *seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  double* const seconds_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// E of a model whose every value is off by a few rounding errors of the measured one: nothing lower
// means anything.
double ExactObjective(const Objective& objective);

// What all solvers share, from the start of a run to its summary: the clock, the trace, the best
// model, the stopping test and the callback. A solver makes its steps in between:
//
//   Run run("name", objective, options, model);
//   { auto timer = run.Time(&PhaseSeconds::preparing); ...sort, copy... }
//   for (bool go_on = run.Start(); go_on;) {
//     ...move `current`...
//     go_on = run.Record(current);
//   }
//   return run.Finish();
class Run {
 public:
  // What a solver knows of an iteration besides the model.
  struct Step {
    bool filtered = false;
    bool accepted = true;
    bool may_converge = true;  // false where more is to come, however little this one lowered E
    std::optional<double> optimality = std::nullopt;
    std::optional<double> objective =
        std::nullopt;  // Objective::Value of the model, if it has been computed
  };

  // The clock starts here. *model is the starting point, and receives the best point.
  Run(std::string solver, const Objective& objective, const SolverOptions& options,
      FactorModel* model);

  const SolverOptions& options() const { return summary_.used; }
  SolverSummary& summary() { return summary_; }  // for used options, notes and phases
  ScopedTimer Time(double PhaseSeconds::*phase) { return ScopedTimer(&(summary_.phases.*phase)); }
  double seconds() const;
  double best_objective() const { return best_objective_; }  // of what is minimised

  // Records the starting point; false when there is nothing to do. Throws Error if E overflows
  // there.
  bool Start(std::optional<double> optimality = std::nullopt);

  // Records the next iteration; false when it is time to stop. A step that was not accepted comes
  // with the model before it.
  bool Record(const FactorModel& current, const Step& step);
  bool Record(const FactorModel& current) { return Record(current, Step()); }

  // Ends the run for a reason that only the solver knows. Keeps an earlier reason.
  void Stop(StopReason reason);
  bool stopped() const { return reason_.has_value(); }
  // Whether there is no time for more, in the midst of an iteration. From any thread.
  bool IsToStop() const;

  SolverSummary Finish();

 private:
  std::optional<StopReason> ReasonToStop(bool may_converge) const;

  const Objective& objective_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  const double exact_objective_;
  FactorModel* const model_;  // the best so far
  double best_objective_ = 0;
  FactorModel previous_;
  std::optional<StopReason> reason_;
  SolverSummary summary_;
};

// The loop of the solvers that do nothing but repeat: `sweep` updates every parameter of its
// argument once; then comes the filter on G where the options ask for it.
void RepeatSweeps(const std::function<void(FactorModel*)>& sweep, const Objective& objective,
                  FactorModel current, Run* run);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_RUN_H_
