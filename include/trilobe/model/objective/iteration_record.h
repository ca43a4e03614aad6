#ifndef TRILOBE_MODEL_OBJECTIVE_ITERATION_RECORD_H_
#define TRILOBE_MODEL_OBJECTIVE_ITERATION_RECORD_H_

#include <optional>

namespace trilobe {

// The state of a fit after one iteration (for AWLS, a sweep over all parameters).
struct IterationRecord {
  int iteration = 0;      // 0 is the starting point
  double seconds = 0;     // since Solve() was called, its own preparations included
  double objective = 0;   // E of the data, by Objective::Value
  bool filtered = false;  // the Gaussian filter ran after this iteration, so E may have risen
  bool accepted = true;   // false: the step that was tried did not lower E, and was taken back
  double step = 0;        // |x - x before| / |x before| over all parameters; 0 at the start
  // Scaled projected gradient (docs/solvers.md), by the solvers that know it at each iteration.
  std::optional<double> optimality = std::nullopt;
  // With a prior: E of the data and of what the prior says, which the solver lowers.
  std::optional<double> objective_with_prior = std::nullopt;

  double minimised() const { return objective_with_prior.value_or(objective); }
  bool operator==(const IterationRecord&) const = default;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_ITERATION_RECORD_H_
