#ifndef TRILOBE_SOLVERS_SUMS_GRID_JOINT_ROWS_H_
#define TRILOBE_SOLVERS_SUMS_GRID_JOINT_ROWS_H_

#include <memory>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/folded_grid.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

class RowLayout;
struct RowAccumulator;

// The part of H and J'r in which d, s, D or F take part, from one streaming pass over the rows
// (theta_h, theta_d) of a folded grid (docs/sums.md).
//
// In a row and channel rho = sum_a x_a phi_a as in CellSums. A parameter of d, s, D or F moves it
// by known multiples v_a of the phi_a, so that two of them have the product v.A.v' with CellSums'
// A_ab = sum w phi_a phi_b. A node k of table t of G moves it by
//   X_t z_tk,   X_t = sum of x_m over the lobes m that t serves,
//   z_tk = (B_k(theta_i) G_t(theta_o) + G_t(theta_i) B_k(theta_o)) / (cos cos),
// so its product with the former is the sum of  q z_tk,  q = w X_t v.phi.  A sample reads four
// nodes a side, and a row has one parameter each of d, s, D and F a channel and lobe: the sample's
// q of all of them times its weights B go to their places in the cache, those of d, s and D from
// all rows of a theta_h, those of F from all rows of a theta_d.
//
// One more q, w X_t r (r the residual), gives the gradient of G. The second derivatives of E beyond
// J'J: rho = s D F K is linear in each of s, D, F, so these are  b = sum w r K  times what is left
// of s D F when two are taken out, and, with a node of G,  w r dX_t  more in q.
class JointRows {
 public:
  JointRows(const FoldedGrid& folded, const ModelSpec& spec);
  ~JointRows();

  // Sets the upper triangle's rows of d, s, D and F, which were 0, the whole gradient, and the
  // squared lengths of those columns. The same bits for any number of threads.
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

#endif  // TRILOBE_SOLVERS_SUMS_GRID_JOINT_ROWS_H_
