#ifndef TRILOBE_SOLVERS_SUMS_CELL_SUMS_H_
#define TRILOBE_SOLVERS_SUMS_CELL_SUMS_H_

#include <functional>
#include <span>
#include <vector>

#include "solvers/sums/kernels.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/folded_grid.h"

namespace trilobe {

// Updates of d, s, D and F from sums over the cells (theta_h, theta_d), exact for fixed G
// (docs/sums.md).
//
// In a cell and channel the model is linear in a few basis functions of the sample,
//   rho = sum_a x_a phi_a,  phi_0 = 1, phi_m = K_m = G^m(theta_i) G^m(theta_o) / (cos cos),
//   x_0 = d, x_m = s^m D^m(theta_h) F(theta_d),
// so E depends on its samples only through
//   b_a = sum w r phi_a  (r = rho* - rho, the current residual)  and  A_ab = sum w phi_a phi_b.
// Moving x by delta v changes E by -2 delta v.b + delta^2 v.A.v, and b by -delta A v. Several
// elements with directions v_k change E by delta'H delta - 2 g'delta, g_k = v_k.b and
// H_kl = v_k.A.v_l, summed over the cells. Sums of residuals instead of measured values keep their
// accuracy when the fit is good.
class CellSums {
 public:
  CellSums(const FoldedGrid& folded, const ModelSpec& spec);

  // Sets b and A of every cell and channel by one pass over the samples.
  void Accumulate(const FactorModel& model, int num_threads);

  // Sets every element of d, s, D, F, in this order, to the minimum of E with the others held. The
  // sums must be of this model. `on_element`, if set, sees the model after each.
  void UpdateAll(const std::function<void(const FactorModel&)>& on_element, FactorModel* model);

  // Likewise minimises E over blocks (SolveNonnegativeLeastSquares): d and s of one channel, then D
  // of one theta_h bin and all lobes, then F of one theta_d bin and all lobes; channels that share
  // no table separately. E: of the model of Accumulate, for the accuracy of the sums. `on_block`,
  // if set, sees the model after each. The same bits for any number of threads.
  void UpdateBlocks(double E, int num_threads,
                    const std::function<void(const FactorModel&)>& on_block, FactorModel* model);

  int basis() const { return basis_; }  // 1 + lobes
  // Stride of the rows of A, which are padded with 0.
  int padded_basis() const { return padded_; }
  const double* b(int h, int d, int c) const {  // [basis]
    return &numbers_[static_cast<size_t>((h * folded_.grid.theta_d + d) * kChannels + c) *
                     stride()];
  }
  const double* A(int h, int d, int c) const {  // [basis][padded basis], symmetric
    return b(h, d, c) + padded_;
  }

 private:
  struct Range {
    int begin, end;
  };
  // Cells that the same elements move.
  struct Block {
    Range h, d, channels;
  };

  // Puts an element where E is lowest. moved(h, d, c) tells how it moves a cell's x.
  template <typename Moved>
  void Update(const Block& block, const Moved& moved, double* element);

  // The same for several together. element_of: the number of the one that moves each entry of x, or
  // -1. [basis]. E: as for UpdateBlocks.
  void UpdateBlock(const MovedCells& cells, std::span<const int> element_of,
                   std::span<double* const> elements, double E) const;

  int stride() const { return padded_ + padded_ * padded_; }
  double* mutable_b(int h, int d, int c) { return const_cast<double*>(b(h, d, c)); }

  const FoldedGrid& folded_;
  const ModelSpec spec_;
  const int basis_, padded_;
  std::vector<double> numbers_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_CELL_SUMS_H_
