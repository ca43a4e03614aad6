#ifndef TRILOBE_SOLVERS_GRID_SWEEP_H_
#define TRILOBE_SOLVERS_GRID_SWEEP_H_

#include <functional>
#include <string>

#include "trilobe/solvers/cell_sums.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/shadowing_sums.h"

namespace trilobe {

// A sweep of AWLS from exact sums: the same element updates in the same order as the literal one,
// but with one pass over the samples for d, s, D, F (CellSums) and one for each table of G
// (ShadowingSums), instead of one for each element's share of them.
class GridSweep {
 public:
  // Throws Error that names the solver unless the samples are on a grid. Times go to *phases.
  GridSweep(const std::string& solver, const Objective& objective, PhaseSeconds* phases);

  // Updates every parameter once. `on_element`, if set, sees the model after each.
  void operator()(const std::function<void(const FactorModel&)>& on_element, FactorModel* model);

  // Updates d, s, D, F in blocks (CellSums::UpdateBlocks) several times, which takes no further
  // pass over the samples, and every node of G once. The first sweeps of a run go element by
  // element all the same: as long as G is far off, exact blocks settle too early which lobe is
  // what. `last` is the record of the model as it comes. `on_block`, if set, sees it after each
  // block and node.
  void InBlocks(const IterationRecord& last,
                const std::function<void(const FactorModel&)>& on_block, FactorModel* model);

 private:
  void AccumulateCells(const FactorModel& model);
  void UpdateG(const std::function<void(const FactorModel&)>& on_element, FactorModel* model);

  const int num_threads_;
  PhaseSeconds* const phases_;
  CellSums cells_;
  ShadowingSums shadowing_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_GRID_SWEEP_H_
