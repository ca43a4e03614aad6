#ifndef TRILOBE_SOLVERS_AWLS_GRID_SWEEP_H_
#define TRILOBE_SOLVERS_AWLS_GRID_SWEEP_H_

#include <optional>

#include "solvers/awls/sweep.h"
#include "solvers/sums/grid/cell_sums.h"
#include "solvers/sums/grid/shadowing_sums.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/run.h"

namespace trilobe {

// Sweeps from exact sums, on a grid: the same element updates in the same order as the reference,
// but with one pass over the samples for d, s, D, F (CellSums) and one for each table of G
// (ShadowingSums), instead of one for each element's share of them. Several rounds of blocks take
// no further pass.
class GridSweep : public Sweep {
 public:
  // The objective, which must outlive the sweep, has its samples on a grid. Times go to *phases.
  GridSweep(const Objective& objective, PhaseSeconds* phases);

  void operator()(const OnElement& on_element, FactorModel* model) override;

 private:
  void UpdateBlocks(double E, int rounds, const OnElement& on_block, FactorModel* model) override;
  void UpdateG(const OnElement& on_element, FactorModel* model) override;
  void AccumulateCells(const FactorModel& model);

  const Objective& objective_;
  PhaseSeconds* const phases_;
  CellSums cells_;
  std::optional<ShadowingSums> shadowing_;  // once G is updated; projections do without
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_AWLS_GRID_SWEEP_H_
