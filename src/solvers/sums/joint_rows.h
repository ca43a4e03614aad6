#ifndef TRILOBE_SOLVERS_SUMS_JOINT_ROWS_H_
#define TRILOBE_SOLVERS_SUMS_JOINT_ROWS_H_

#include <memory>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/folded_grid.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

class RowLayout;
struct RowAccumulator;

// The part of H and J'r that involves d, s, D or F, from one pass over the rows (theta_h, theta_d)
// of a folded grid (docs/sums.md).
//
// In a row and channel rho = sum_a x_a phi_a as in CellSums. The derivatives by parameters of d, s,
// D and F are sums v_a phi_a with known v, so two of them have the product v.A.v', with
// A_ab = sum w phi_a phi_b of CellSums. The derivative by node k of table t of G is
//   X_t z_tk,   X_t = sum of x_m over the lobes m that t serves,
//   z_tk = (B_k(theta_i) G_t(theta_o) + G_t(theta_i) B_k(theta_o)) / (cos cos),
// so its product with the former is the sum of  q z_tk,  q = w X_t v.phi.  A sample reads four
// nodes per side, and a row has one parameter each of d, s, D and F per channel and lobe. Their q
// times the weights B are summed in the cache: those of d, s and D over all rows of a theta_h,
// those of F over all rows of a theta_d.
//
// Another q, w X_t r (r the residual), gives the gradient of G. Second derivatives: rho = s D F K
// is linear in each of s, D, F, so they are  b = sum w r K  times the remaining factor of s D F,
// and, with a node of G, q has the additional term  w r dX_t.
class JointRows {
 public:
  JointRows(const FoldedGrid& folded, const ModelSpec& spec);
  ~JointRows();

  // Sets the rows of d, s, D and F of the upper triangle (0 before), the whole gradient, and the
  // squared lengths of these columns. The same bits for any number of threads.
  void Evaluate(const FactorModel& model, Hessian hessian, int num_threads, QuadraticModel* result);

 private:
  void ReadRow(const FactorModel& model, const std::vector<std::vector<CatmullRom::Piece>>& G,
               int h, int d, RowAccumulator* accumulator) const;
  void AddProducts(const FactorModel& model, Hessian hessian, int h, int d,
                   RowAccumulator* accumulator) const;
  void AddCrossProducts(Hessian hessian, int d, RowAccumulator* accumulator) const;
  void SpreadThetaH(const FactorModel& model, Hessian hessian, int h,
                    RowAccumulator* accumulator) const;
  void TakeThetaH(const FactorModel& model, int h, RowAccumulator* accumulator,
                  QuadraticModel* result) const;
  void SetThetaD(const FactorModel& model, Hessian hessian, int d, QuadraticModel* result) const;
  void SetAmplitudes(const FactorModel& model, QuadraticModel* result) const;

  const FoldedGrid& folded_;
  const std::unique_ptr<const RowLayout> layout_;
  std::vector<std::unique_ptr<RowAccumulator>> accumulators_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_JOINT_ROWS_H_
