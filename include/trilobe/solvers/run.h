#ifndef TRILOBE_SOLVERS_RUN_H_
#define TRILOBE_SOLVERS_RUN_H_

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "trilobe/solvers/solver.h"

namespace trilobe {

// Adds its lifetime to *seconds.
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

// E of a model whose values differ from the measured ones by four rounding errors. A lower E means
// nothing.
double ExactObjective(const Objective& objective);

// The part of a run that all solvers share: clock, trace, best model, stopping test, callbacks and
// summary. A solver makes the steps in between:
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
  // A solver's report on an iteration, besides the model.
  struct Step {
    bool filtered = false;
    bool accepted = true;
    bool may_converge = true;  // false: a small decrease of E does not end the run
    std::optional<double> optimality = std::nullopt;
    std::optional<double> objective =
        std::nullopt;  // Objective::Value of the model, if it has been computed
  };

  // Starts the clock. *model is the starting point and receives the best point.
  Run(std::string solver, const Objective& objective, const SolverOptions& options,
      FactorModel* model);

  const SolverOptions& options() const { return summary_.used; }
  SolverSummary& summary() { return summary_; }  // to set used options, notes and phases
  ScopedTimer Time(double PhaseSeconds::*phase) { return ScopedTimer(&(summary_.phases.*phase)); }
  double seconds() const;
  double best_objective() const { return best_objective_; }  // minimised E of the best point

  // Records the starting point. Returns false if the run is to stop there. Throws Error if E
  // overflows.
  bool Start(std::optional<double> optimality = std::nullopt);

  // Records the next iteration. Returns false if the run is to stop. For a rejected step, `current`
  // is the model before it.
  bool Record(const FactorModel& current, const Step& step);
  bool Record(const FactorModel& current) { return Record(current, Step()); }

  // Ends the run for a reason of the solver's. An earlier reason is kept.
  void Stop(StopReason reason);
  bool stopped() const { return reason_.has_value(); }
  // For use within an iteration: whether max_seconds is over or the stop callback returns true.
  // Thread-safe.
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

// Repeats `sweep`, which updates every parameter of its argument once, until the run stops. Applies
// the filter on G after each sweep if the options ask for it.
void RepeatSweeps(const std::function<void(FactorModel*)>& sweep, const Objective& objective,
                  FactorModel current, Run* run);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_RUN_H_
