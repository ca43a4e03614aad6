#ifndef TRILOBE_SOLVERS_SHADOWING_SUMS_H_
#define TRILOBE_SOLVERS_SHADOWING_SUMS_H_

#include <array>
#include <functional>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/folded_grid.h"
#include "trilobe/solvers/node_quartics.h"

namespace trilobe {

// Element updates of G from moments of spline weights, exact for fixed d, s, D, F (docs/method.md).
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
  // Keeps a copy of the samples, sorted by cell.
  ShadowingSums(const FoldedGrid& folded, const ModelSpec& spec);

  // For each table of G in turn: passes over the samples once, then puts every node, in order,
  // where E is lowest with all else held. `on_element`, if set, sees the model after each.
  void UpdateAll(int num_threads, const std::function<void(const FactorModel&)>& on_element,
                 FactorModel* model);

 private:
  // The samples of one pair of knot intervals.
  struct Cell {
    int interval_i = 0, interval_o = 0;
    int begin = 0, end = 0;
  };

  using Pieces = std::vector<std::vector<CatmullRom::Piece>>;

  void ComputeAmplitudes(const FactorModel& model);
  void Accumulate(const FactorModel& model, int table, int num_threads);
  SplineMoments CellMoments(const Cell& cell, const FactorModel& model, int table,
                            const Pieces& G) const;

  ModelSpec spec_;
  int theta_d_;
  int num_rows_;
  std::vector<Cell> cells_;
  // By cell. [size]
  std::vector<int> row_;
  std::vector<double> t_i_, t_o_, inverse_cosines_;
  std::array<std::vector<double>, kChannels> weight_, rho_;

  std::vector<double> amplitudes_;  // s D F. [kChannels][lobes][rows]
  std::vector<NodeQuartics::CellTerms> terms_;
  NodeQuartics quartics_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SHADOWING_SUMS_H_
