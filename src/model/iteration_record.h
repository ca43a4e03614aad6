#ifndef TRILOBE_MODEL_ITERATION_RECORD_H_
#define TRILOBE_MODEL_ITERATION_RECORD_H_

namespace trilobe {

// The state of a fit after one iteration (for AWLS, a sweep over all parameters).
struct IterationRecord {
  int iteration = 0;      // 0 is the starting point
  double seconds = 0;     // since Solve() was called, its own preparations included
  double objective = 0;   // E by Objective::Value
  bool filtered = false;  // the Gaussian filter ran after this iteration, so E may have risen

  bool operator==(const IterationRecord&) const = default;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_ITERATION_RECORD_H_
