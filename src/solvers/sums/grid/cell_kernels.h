#ifndef TRILOBE_SOLVERS_SUMS_GRID_CELL_KERNELS_H_
#define TRILOBE_SOLVERS_SUMS_GRID_CELL_KERNELS_H_

#include <cstddef>

#include "trilobe/model/model_spec.h"

// What CellSums does with many cells, in loops over whole vectors.
namespace trilobe {

// b of a cell and the rows of A are padded to whole vectors.
constexpr int PaddedBasis(int basis) { return (basis + 3) / 4 * 4; }
inline constexpr int kMaxCellBasis = PaddedBasis(1 + kMaxLobes);

// Cells in `outer` rows of `inner`, and a direction v in which the x of each is moved.
struct MovedCells {
  struct {
    double* first;  // b [basis], then A [basis][basis], of a cell
    int outer, inner;
    size_t outer_stride, inner_stride;
  } cells;
  struct {
    const double* first;  // [basis]
    size_t outer_stride, inner_stride;
  } v;
};

// Adds sum v_a b_a to g [basis], sum v_a v_e A_ae to H [basis][basis].
void AddAlong(const MovedCells& moved, int basis, double* g, double* H);

// b_e -= sum_a steps_a v_a A_ae in each cell.
void MoveAlong(const MovedCells& moved, int basis, const double* steps);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_GRID_CELL_KERNELS_H_
