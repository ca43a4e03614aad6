#ifndef TRILOBE_MODEL_OBJECTIVE_ITERATION_RECORD_H_
#define TRILOBE_MODEL_OBJECTIVE_ITERATION_RECORD_H_

#include <optional>

namespace trilobe {

// The state of a fit after one iteration (in AWLS, one sweep over all parameters).
struct IterationRecord {
  int iteration = 0;      // 0 is the starting point
  double seconds = 0;     // since the start of Solve(), with its preparations
  double objective = 0;   // E of the data (Objective::Value)
  bool filtered = false;  // the Gaussian filter ran after it; E may have risen
  bool accepted = true;   // false: the step did not lower E and was undone
  double step = 0;        // |x - previous x| / |previous x|; 0 at the start
  // Scaled projected gradient (docs/solvers.md), if the solver computes it.
  std::optional<double> optimality = std::nullopt;
  // Processor time of all threads of this process since its start [s]; other work on the machine
  // affects it less than `seconds`. Unknown in traces of older programs.
  std::optional<double> processor_seconds = std::nullopt;
  // With a prior: E of data and prior samples together, which the solver minimises.
  std::optional<double> objective_with_prior = std::nullopt;

  double minimised() const { return objective_with_prior.value_or(objective); }
  bool operator==(const IterationRecord&) const = default;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_ITERATION_RECORD_H_
