#ifndef TRILOBE_CORE_SYSTEM_EVALUATION_COUNT_H_
#define TRILOBE_CORE_SYSTEM_EVALUATION_COUNT_H_

#include <atomic>
#include <cstdint>

namespace trilobe {

// How often an objective, and its derivatives by all parameters at once, have been computed.
struct EvaluationCount {
  std::atomic<int64_t> values{0}, derivatives{0};
};

// While it lives, what this thread computes counts, and what threads of ParallelFor and
// ParallelJobs compute for it. Null counts nothing.
class CountEvaluations {
 public:
  explicit CountEvaluations(EvaluationCount* count);
  ~CountEvaluations();
  CountEvaluations(const CountEvaluations&) = delete;
  CountEvaluations& operator=(const CountEvaluations&) = delete;

 private:
  EvaluationCount* const outer_;
};

// The count of this thread, or null.
EvaluationCount* CountHere();

// For what computes them.
void CountValues(int64_t count);
void CountDerivatives(int64_t count);

}  // namespace trilobe

#endif  // TRILOBE_CORE_SYSTEM_EVALUATION_COUNT_H_
