#include "trilobe/solvers/awls/sweep.h"

#include "trilobe/solvers/awls/grid_sweep.h"
#include "trilobe/solvers/awls/sample_sweep.h"

namespace trilobe {

void Sweep::InBlocks(const IterationRecord& last, const OnElement& on_block, FactorModel* model) {
  // What other parameters do to E: docs/solvers.md.
  constexpr int kElementSweeps = 3;
  if (last.iteration < kElementSweeps) {
    (*this)(on_block, model);
    return;
  }
  UpdateBlocks(last.minimised(), rounds_, on_block, model);
  UpdateG(on_block, model);
}

std::unique_ptr<Sweep> MakeSweep(const Objective& objective, PhaseSeconds* phases) {
  if (objective.folded() != nullptr) return std::make_unique<GridSweep>(objective, phases);
  return std::make_unique<SampleSweep>(*objective.folded_samples(), objective.spec(),
                                       objective.num_threads(), phases);
}

}  // namespace trilobe
