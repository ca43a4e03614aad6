#ifndef TRILOBE_SOLVERS_SUMS_NORMAL_EQUATIONS_H_
#define TRILOBE_SOLVERS_SUMS_NORMAL_EQUATIONS_H_

#include <memory>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

class ScatteredEquations;

// Accumulates a QuadraticModel in one pass over the samples, without storing J (docs/sums.md).
// Samples on a grid are folded and summed by cells; others are summed one by one
// (ScatteredEquations).
class NormalEquations {
 public:
  explicit NormalEquations(const Objective& objective);
  ~NormalEquations();

  // Sets *result. The same bits for any number of threads.
  void Evaluate(const FactorModel& model, Hessian hessian, QuadraticModel* result);

 private:
  class Condensed;
  const Objective& objective_;
  std::unique_ptr<Condensed> condensed_;            // for samples on a grid, else null
  std::shared_ptr<const FoldedSamples> fold_;       // of other samples, else null
  std::unique_ptr<ScatteredEquations> of_samples_;  // for other samples, else null
};

// The same from the derivatives of each sample: slow, the reference for tests.
void EvaluateReference(const Objective& objective, const FactorModel& model, Hessian hessian,
                       QuadraticModel* result);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_NORMAL_EQUATIONS_H_
