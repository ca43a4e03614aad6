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
  // Throws Error that names the solver unless the samples are on a grid. Times are the run's.
  GridSweep(const std::string& solver, const Objective& objective, Run* run);

  // Updates every parameter once. `on_element`, if set, sees the model after each.
  void operator()(const std::function<void(const FactorModel&)>& on_element, FactorModel* model);

 private:
  const int num_threads_;
  Run* const run_;
  CellSums cells_;
  ShadowingSums shadowing_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_GRID_SWEEP_H_
