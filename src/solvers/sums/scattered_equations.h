#ifndef TRILOBE_SOLVERS_SUMS_SCATTERED_EQUATIONS_H_
#define TRILOBE_SOLVERS_SUMS_SCATTERED_EQUATIONS_H_

#include <vector>

#include "model/objective/batch_evaluator.h"
#include "solvers/sums/add_normal_equations.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/folded_samples.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

// The normal equations of any samples in all parameters x of a model:
//   g = sum w v r,  H = sum w v v',  r = rho - rho*,  v = d rho / d x
// over samples and channels; for Hessian::kNewton H also has w r d2 rho / dx dx'. Each thread sums
// its samples (AddNormalEquations); the sums are then added and put in the order of the parameters.
class ScatteredEquations {
 public:
  ScatteredEquations(const FoldedSamples& samples, const ModelSpec& spec, int num_threads);

  // Sets all of *result. The same bits for any number of threads.
  void Evaluate(const FactorModel& model, Hessian hessian, QuadraticModel* result);

 private:
  void GatherOwn(const AccumulatorRows& rows, int entry, QuadraticModel* result) const;
  void GatherBlocks(const AccumulatorRows& rows, int first_entry, int last_entry,
                    QuadraticModel* result) const;
  void GatherCells(const AccumulatorRows& rows, QuadraticModel* result) const;
  void GatherSquaredLengths(const AccumulatorRows& rows, Hessian hessian,
                            QuadraticModel* result) const;

  BatchEvaluator reader_;
  const int num_threads_;
  AccumulatorLayout layout_;
  int num_parameters_ = 0;
  std::vector<std::vector<double>> accumulators_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_SCATTERED_EQUATIONS_H_
