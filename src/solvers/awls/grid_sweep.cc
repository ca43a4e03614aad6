#include "solvers/awls/grid_sweep.h"

#include <glog/logging.h>

namespace trilobe {

GridSweep::GridSweep(const Objective& objective, PhaseSeconds* phases)
    : Sweep(/*rounds=*/5),  // after the first, they cost next to nothing
      objective_(objective),
      phases_(phases),
      cells_(*CHECK_NOTNULL(objective.folded()), objective.spec()) {}

void GridSweep::operator()(const OnElement& on_element, FactorModel* model) {
  AccumulateCells(*model);
  {
    const ScopedTimer timer(&phases_->linear_algebra);
    cells_.UpdateAll(on_element, model);
  }
  UpdateG(on_element, model);
}

void GridSweep::UpdateBlocks(double E, int rounds, const OnElement& on_block, FactorModel* model) {
  AccumulateCells(*model);
  const ScopedTimer timer(&phases_->linear_algebra);
  for (int k = 0; k < rounds; ++k) {
    cells_.UpdateBlocks(E, objective_.num_threads(), on_block, model);
  }
}

void GridSweep::AccumulateCells(const FactorModel& model) {
  const ScopedTimer timer(&phases_->evaluating);
  cells_.Accumulate(model, objective_.num_threads());
}

void GridSweep::UpdateG(const OnElement& on_element, FactorModel* model) {
  if (!shadowing_) {
    const ScopedTimer timer(&phases_->preparing);
    shadowing_.emplace(objective_.spline_cells(), objective_.spec());
  }
  for (int t = 0; t < model->spec().num_tables(Factor::kG); ++t) {
    {
      const ScopedTimer timer(&phases_->evaluating);
      shadowing_->Accumulate(*model, t, objective_.num_threads());
    }
    const ScopedTimer timer(&phases_->linear_algebra);
    shadowing_->UpdateTable(t, on_element, model);
  }
}

}  // namespace trilobe
