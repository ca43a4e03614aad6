#ifndef TRILOBE_SOLVERS_AWLS_SAMPLE_SWEEP_H_
#define TRILOBE_SOLVERS_AWLS_SAMPLE_SWEEP_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/objective/folded_samples.h"
#include "trilobe/solvers/awls/sweep.h"
#include "trilobe/solvers/run.h"
#include "trilobe/sums/sample_equations.h"
#include "trilobe/sums/sample_shadowing.h"

namespace trilobe {

// Sweeps from the samples themselves, whatever tables they read and where: the same element updates
// in the same order as the reference. In d and s, in D, and in F E is quadratic, so one pass over
// the samples for each of the three gives sums from which all of its elements can be updated. G
// goes node by node (SampleShadowing).
class SampleSweep : public Sweep {
 public:
  SampleSweep(const FoldedSamples& samples, const ModelSpec& spec, int num_threads,
              PhaseSeconds* phases);

  void operator()(const OnElement& on_element, FactorModel* model) override;

 private:
  void UpdateBlocks(double E, int rounds, const OnElement& on_block, FactorModel* model) override;
  void UpdateG(const OnElement& on_element, FactorModel* model) override;

  // Sets at_ to E around the model as a function of the parameters of one kind.
  void Accumulate(Kind kind, const FactorModel& model);
  // Puts parameters of that kind, by their places in at_ and in the model, where E is lowest.
  void Update(std::span<const int> places, int first, double E, FactorModel* model);

  const ModelSpec spec_;
  PhaseSeconds* const phases_;
  std::vector<SampleEquations> equations_;  // of amplitudes, D and F
  SampleShadowing shadowing_;
  QuadraticModel at_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_AWLS_SAMPLE_SWEEP_H_
