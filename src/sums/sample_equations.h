#ifndef TRILOBE_SUMS_SAMPLE_EQUATIONS_H_
#define TRILOBE_SUMS_SAMPLE_EQUATIONS_H_

#include <memory>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/objective/objective.h"
#include "trilobe/objective/quadratic_model.h"

namespace trilobe {

// The normal equations of any samples, one by one. In one channel a sample moves with some 40
// numbers, those of its stencils; their products go straight to their places in H.
class SampleEquations {
 public:
  explicit SampleEquations(const Objective& objective);
  ~SampleEquations();

  // Sets all of *result, which was 0 and has its sizes. The same bits for any number of threads.
  void Evaluate(const FactorModel& model, Hessian hessian, QuadraticModel* result);

 private:
  struct Share;

  const Objective& objective_;
  std::vector<std::unique_ptr<Share>> shares_;
};

}  // namespace trilobe

#endif  // TRILOBE_SUMS_SAMPLE_EQUATIONS_H_
