#ifndef TRILOBE_SOLVERS_SUMS_NORMAL_EQUATIONS_H_
#define TRILOBE_SOLVERS_SUMS_NORMAL_EQUATIONS_H_

#include <memory>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

class ScatteredEquations;

// Accumulates a QuadraticModel without ever storing J, in one pass over the samples
// (docs/sums.md). Samples on a grid are taken folded, by their cells; others one by one
// (ScatteredEquations).
class NormalEquations {
 public:
  explicit NormalEquations(const Objective& objective);
  ~NormalEquations();

  // The same bits for any number of threads.
  void Evaluate(const FactorModel& model, Hessian hessian, QuadraticModel* result);

 private:
  class Condensed;
  const Objective& objective_;
  std::unique_ptr<Condensed> condensed_;  // null where samples are not on a grid; then:
  std::unique_ptr<ScatteredEquations> of_samples_;
};

// The same from each sample's own derivatives, in a time that only small data forgive: the
// reference for tests.
void EvaluateReference(const Objective& objective, const FactorModel& model, Hessian hessian,
                       QuadraticModel* result);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_NORMAL_EQUATIONS_H_
