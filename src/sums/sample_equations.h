#ifndef TRILOBE_SUMS_SAMPLE_EQUATIONS_H_
#define TRILOBE_SUMS_SAMPLE_EQUATIONS_H_

#include <vector>

#include "objective/sample_reader.h"
#include "sums/sample_sums.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/objective/folded_samples.h"
#include "trilobe/objective/quadratic_model.h"

namespace trilobe {

// The normal equations of any samples, of all parameters of a model (AddSampleSums).
class SampleEquations {
 public:
  SampleEquations(const FoldedSamples& samples, const ModelSpec& spec, int num_threads);

  // Sets all of *result. The same bits for any number of threads.
  void Evaluate(const FactorModel& model, Hessian hessian, QuadraticModel* result);

 private:
  void GatherOwn(const SampleRows& rows, int entry, QuadraticModel* result) const;
  void GatherBlocks(const SampleRows& rows, int first_entry, int last_entry,
                    QuadraticModel* result) const;
  void GatherCells(const SampleRows& rows, QuadraticModel* result) const;
  void GatherSquaredLengths(const SampleRows& rows, Hessian hessian, QuadraticModel* result) const;

  SampleReader reader_;
  const int num_threads_;
  SampleLayout layout_;
  int num_parameters_ = 0;
  std::vector<std::vector<double>> accumulators_;
};

}  // namespace trilobe

#endif  // TRILOBE_SUMS_SAMPLE_EQUATIONS_H_
