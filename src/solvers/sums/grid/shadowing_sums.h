#ifndef TRILOBE_SOLVERS_SUMS_GRID_SHADOWING_SUMS_H_
#define TRILOBE_SOLVERS_SUMS_GRID_SHADOWING_SUMS_H_

#include <functional>
#include <vector>

#include "solvers/sums/grid/node_quartics.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/spline_cells.h"

namespace trilobe {

// Element updates of G from moments of spline weights, exact for fixed d, s, D, F (docs/sums.md).
//
// With y = s D F / (cos cos), summed over the lobes that a table serves, and B_a the spline's
// weight of node a, a change of the table from G0 to G changes a sample's value by
//   y sum_ab B_a(theta_i) B_b(theta_o) (G_a G_b - G0_a G0_b).
// E therefore depends on the samples of a cell (knot interval of theta_i, knot interval of theta_o)
// only through  sum w y r B_a B_b  (r the residual)  and  sum w y^2 B_a B_b B_c B_d.  The weights
// are cubics in the place t within an interval, so these follow from 4 x 4 and 7 x 7 moments
//   sum_C w y r t_i^k t_o^l  and  sum_C w y^2 t_i^k t_o^l,
// which is all that the pass over the samples adds up (SplineMoments); NodeQuartics does the rest.
class ShadowingSums {
 public:
  ShadowingSums(const SplineCells& samples, const ModelSpec& spec);

  // Passes over the samples once: sets the sums of one table of G.
  void Accumulate(const FactorModel& model, int table, int num_threads);

  // Puts every node of that table, in order, where E is lowest with all else held, by the sums of
  // this model and table. `on_element`, if set, sees the model after each.
  void UpdateTable(int table, const std::function<void(const FactorModel&)>& on_element,
                   FactorModel* model);

 private:
  using Pieces = std::vector<std::vector<CatmullRom::Piece>>;

  SplineMoments CellMoments(const SplineCells::Cell& cell, const FactorModel& model, int table,
                            const Pieces& G, const std::vector<double>& amplitudes) const;

  ModelSpec spec_;
  const SplineCells& samples_;
  std::vector<NodeQuartics::CellTerms> terms_;  // by cell
  NodeQuartics quartics_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_GRID_SHADOWING_SUMS_H_
