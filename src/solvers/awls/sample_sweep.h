#ifndef TRILOBE_SOLVERS_AWLS_SAMPLE_SWEEP_H_
#define TRILOBE_SOLVERS_AWLS_SAMPLE_SWEEP_H_

#include <functional>
#include <vector>

#include "solvers/awls/sweep.h"
#include "solvers/sums/block_equations.h"
#include "solvers/sums/cached_lookups.h"
#include "solvers/sums/shadowing_updates.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/folded_samples.h"
#include "trilobe/solvers/run.h"

namespace trilobe {

// Sweeps from the samples themselves, whatever tables they read and where: the same element updates
// in the same order as the reference. E is quadratic in d and s, in F, and in the tables of D that
// are read by one stretch, so that one pass over the samples for each gives sums from which all of
// its elements can be updated (BlockEquations). G goes node by node (ShadowingUpdates).
class SampleSweep : public Sweep {
 public:
  SampleSweep(const FoldedSamples& samples, const ModelSpec& spec, int num_threads,
              PhaseSeconds* phases);

  void operator()(const OnElement& on_element, FactorModel* model) override;

 private:
  // Where lobes are read by different stretches, an entry of D of those that share one is a block.
  void UpdateBlocks(double E, int rounds, const OnElement& on_block, FactorModel* model) override;
  void UpdateG(const OnElement& on_element, FactorModel* model) override;

  // Reads and sums around the model, calls `update`, which moves it, and reads what has moved.
  void UpdateFrom(BlockEquations* sums, FactorModel* model, const std::function<void()>& update);

  PhaseSeconds* const phases_;
  CachedLookups lookups_;
  // Of amplitudes, of the tables of D that follow each other and are read by one stretch, and of F.
  std::vector<BlockEquations> sums_;
  ShadowingUpdates shadowing_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_AWLS_SAMPLE_SWEEP_H_
