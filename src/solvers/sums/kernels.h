#ifndef TRILOBE_SOLVERS_SUMS_KERNELS_H_
#define TRILOBE_SOLVERS_SUMS_KERNELS_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/multiversion.h"
#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/model/model_spec.h"

// Inner loops of sums over a grid, over whole vectors, compiled for several instruction sets.
namespace trilobe {

// sum += x, element by element. Both have `size` elements and do not overlap.
void AddTo(size_t size, const double* x, double* sum);

// Four polynomials in Bernstein terms, of the nodes that a spline reads in one interval, term by
// term. Aligned, as the vectors alone are only where the machine has them.
template <int kTerms>
struct alignas(sizeof(Lanes4)) OfNodes {
  Lanes4 term[kTerms] = {};
};

// The spline's weights of the four nodes.
inline OfNodes<4> WeightsOfNodes(const CatmullRom& spline, int interval) {
  const auto weights = spline.WeightPolynomials(interval);
  OfNodes<4> transposed;
  for (int k = 0; k < 4; ++k) {
    for (int a = 0; a < 4; ++a) transposed.term[k][a] = weights[a][k];
  }
  return transposed;
}

// --- Kernels of JointRows, over the samples of one row.

// Lines of values, one a sample, are padded to whole batches.
inline constexpr int kBatch = 8;

// B [size][4], the weights of the four nodes at t - 1/2 = v. `columns` are those of the first
// interval, of all within, and of the last.
void SplineWeights(int size, const std::array<OfNodes<4>, 3>& columns, int last_interval,
                   const int16_t* interval, const double* v, double* B);

// K = G(theta_i) G(theta_o) / (cos cos) and, for z, its other side: H_i goes with B(theta_i).
void ReadTable(int size, const CatmullRom::Piece* G, const int16_t* interval_i,
               const int16_t* interval_o, const double* t_i, const double* t_o,
               const double* inverse_cosines, double* K, double* H_i, double* H_o);

// One lobe of a row and channel, and the lines of its s, D and F in q.
struct LobeOfRow {
  double x = 0, DF = 0, sF = 0, sD = 0;  // x = s D F and what it is multiplied with, of each
  const double* K = nullptr;             // [size]
  bool served = false;                   // by the table of G in question
  int s_line = 0, D_line = 0, F_line = 0;
};
using LobesOfRow = std::array<LobeOfRow, kMaxLobes>;

// Sets w_residual = w (rho - rho*) of one channel; returns sum w (rho - rho*)^2.
double WeighResiduals(int size, double d, int lobes, const LobesOfRow& lobe, const double* w,
                      const double* rho, double* w_residual);

// Sums over the samples of a row and channel, by rows of a square matrix of whole vectors:
//   A_ae = sum w phi_a phi_e  and, in one more row,  b_e = sum w r phi_e.
// Adds f_a f_e A_ae and f_e b_e to the sums of its theta_h, g_a g_e A_ae and g_e b_e to those of
// its theta_d. phi: [size][basis]; sums, theta_h_sums, theta_d_sums: [basis + 1][basis]; f, g:
// [basis]. `basis` is padded with phi = 0.
void AddRowSums(int size, int basis, const double* w, const double* w_residual, const double* phi,
                const double* f, const double* g, double* sums, double* theta_h_sums,
                double* theta_d_sums);

// Adds one channel's q (see JointRows) to those of each sample. q: [lines][line_size]
void AddChannel(int size, double X, const double* w, const double* w_residual, int lobes,
                const LobesOfRow& lobe, bool curvature, int d_line, int gradient_line,
                int line_size, double* q);

// to[sample][line] = from[line][sample], in tiles of four by four.
void Transpose(int lines, int size, int line_size, const double* from, double* target);

// Positions of the samples of a row on the spline, and  z = B H  on both sides.
struct RowOfNodes {
  int size;
  const int16_t *interval_i, *interval_o;
  const double *B_i, *B_o;  // [size][4]
  const double *H_i, *H_o;
};

// Adds z q to theta_h_sums [node][theta_h lines] and theta_d_sums [node][theta_d lines], for the
// four nodes of both sides of each sample. q: [size][theta_h lines, then theta_d lines]
void AddCrossSums(const RowOfNodes& row, int theta_h_lines, int theta_d_lines, const double* q,
                  double* theta_h_sums, double* theta_d_sums);

// --- Kernels of CellSums, over many cells.

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

#endif  // TRILOBE_SOLVERS_SUMS_KERNELS_H_
