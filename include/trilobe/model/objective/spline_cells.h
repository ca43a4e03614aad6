#ifndef TRILOBE_MODEL_OBJECTIVE_SPLINE_CELLS_H_
#define TRILOBE_MODEL_OBJECTIVE_SPLINE_CELLS_H_

#include <array>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/objective/folded_grid.h"

namespace trilobe {

// The folded samples sorted by cell (knot interval of theta_i, knot interval of theta_o), in which
// the spline of G is one pair of cubics: for passes that sum products of its weights. Order within
// a cell is kept.
struct SplineCells {
  explicit SplineCells(const FoldedGrid& folded);

  // The samples of a pair of knot intervals; empty cells are omitted.
  struct Cell {
    int interval_i = 0, interval_o = 0;
    int begin = 0, end = 0;
  };

  MerlGrid grid;
  std::vector<Cell> cells;
  // Row of each sample, and the arrays of FoldedGrid, all sorted by cell. [size]
  std::vector<int> row;
  std::vector<double> t_i, t_o, inverse_cosines;
  std::array<std::vector<double>, kChannels> weight, rho;
};

// s D F of every row (theta_h, theta_d). [kChannels][lobes][rows]
std::vector<double> LobeAmplitudes(const MerlGrid& grid, const FactorModel& model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_SPLINE_CELLS_H_
