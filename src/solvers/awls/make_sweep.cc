#include "solvers/awls/make_sweep.h"

#include "solvers/awls/grid_sweep.h"
#include "solvers/awls/sample_sweep.h"

namespace trilobe {

std::unique_ptr<Sweep> MakeSweep(const Objective& objective, PhaseSeconds* phases) {
  if (objective.folded() != nullptr) return std::make_unique<GridSweep>(objective, phases);
  return std::make_unique<SampleSweep>(*objective.folded_samples(), objective.spec(),
                                       objective.num_threads(), phases);
}

}  // namespace trilobe
