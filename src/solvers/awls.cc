#include "trilobe/solvers/awls.h"

#include "trilobe/base/error.h"
#include "trilobe/solvers/cell_sums.h"
#include "trilobe/solvers/shadowing_sums.h"
#include "trilobe/solvers/sweeps.h"

namespace trilobe {

SolverSummary Awls::Solve(const Objective& objective, const SolverOptions& options,
                          FactorModel* model) const {
  const auto start = std::chrono::steady_clock::now();
  const FoldedGrid* const folded = objective.folded();
  if (folded == nullptr) {
    throw Error(objective.samples().source +
                ": solver awls needs samples on a MERL grid; use --solver=awls_literal");
  }
  const int threads = objective.num_threads();
  CellSums cells(*folded, objective.spec());
  ShadowingSums shadowing(*folded, objective.spec());
  const auto sweep = [&](FactorModel* current) {
    cells.UpdateAll(threads, options.on_element, current);
    shadowing.UpdateAll(threads, options.on_element, current);
  };
  return RunSweeps("awls", objective, options, sweep, start, model);
}

}  // namespace trilobe
