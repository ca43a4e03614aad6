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

const SplineCells& TimedSplineCells(const Objective& objective, Run* run) {
  const ScopedTimer timer = run->Time(&PhaseSeconds::preparing);
  return objective.spline_cells();
}

}  // namespace

GridSweep::GridSweep(const std::string& solver, const Objective& objective, Run* run)
    : num_threads_(objective.num_threads()),
      run_(run),
      cells_(FoldedOrThrow(solver, objective), objective.spec()),
      shadowing_(TimedSplineCells(objective, run), objective.spec()) {}

void GridSweep::operator()(const std::function<void(const FactorModel&)>& on_element,
                           FactorModel* model) {
  const auto timed = [this](double PhaseSeconds::*phase, const auto& work) {
    const ScopedTimer timer = run_->Time(phase);
    work();
  };
  timed(&PhaseSeconds::evaluating, [&] { cells_.Accumulate(*model, num_threads_); });
  timed(&PhaseSeconds::linear_algebra, [&] { cells_.UpdateAll(on_element, model); });
  for (int t = 0; t < model->spec().num_tables(Factor::kG); ++t) {
    timed(&PhaseSeconds::evaluating, [&] { shadowing_.Accumulate(*model, t, num_threads_); });
    timed(&PhaseSeconds::linear_algebra, [&] { shadowing_.UpdateTable(t, on_element, model); });
  }
}

}  // namespace trilobe
