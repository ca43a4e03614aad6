#include "trilobe/solvers/grid_sweep.h"

#include "trilobe/base/error.h"

namespace trilobe {
namespace {

const FoldedGrid& FoldedOrThrow(const std::string& solver, const Objective& objective) {
  if (objective.folded() == nullptr) {
    throw Error(objective.samples().source + ": solver " + solver +
                " needs samples on a MERL grid; use --solver=awls_literal");
  }
  return *objective.folded();
}

const SplineCells& TimedSplineCells(const Objective& objective, PhaseSeconds* phases) {
  const ScopedTimer timer(&phases->preparing);
  return objective.spline_cells();
}

}  // namespace

GridSweep::GridSweep(const std::string& solver, const Objective& objective, PhaseSeconds* phases)
    : num_threads_(objective.num_threads()),
      phases_(phases),
      cells_(FoldedOrThrow(solver, objective), objective.spec()),
      shadowing_(TimedSplineCells(objective, phases), objective.spec()) {}

void GridSweep::operator()(const std::function<void(const FactorModel&)>& on_element,
                           FactorModel* model) {
  AccumulateCells(*model);
  {
    const ScopedTimer timer(&phases_->linear_algebra);
    cells_.UpdateAll(on_element, model);
  }
  UpdateG(on_element, model);
}

void GridSweep::InBlocks(const IterationRecord& last,
                         const std::function<void(const FactorModel&)>& on_block,
                         FactorModel* model) {
  // What other numbers do to E: docs/solvers.md.
  constexpr int kElementSweeps = 3, kRounds = 5;
  if (last.iteration < kElementSweeps) {
    (*this)(on_block, model);
    return;
  }
  AccumulateCells(*model);
  {
    const ScopedTimer timer(&phases_->linear_algebra);
    for (int k = 0; k < kRounds; ++k) {
      cells_.UpdateBlocks(last.objective, num_threads_, on_block, model);
    }
  }
  UpdateG(on_block, model);
}

void GridSweep::AccumulateCells(const FactorModel& model) {
  const ScopedTimer timer(&phases_->evaluating);
  cells_.Accumulate(model, num_threads_);
}

void GridSweep::UpdateG(const std::function<void(const FactorModel&)>& on_element,
                        FactorModel* model) {
  for (int t = 0; t < model->spec().num_tables(Factor::kG); ++t) {
    {
      const ScopedTimer timer(&phases_->evaluating);
      shadowing_.Accumulate(*model, t, num_threads_);
    }
    const ScopedTimer timer(&phases_->linear_algebra);
    shadowing_.UpdateTable(t, on_element, model);
  }
}

}  // namespace trilobe
