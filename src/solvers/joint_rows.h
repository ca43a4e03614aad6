#ifndef TRILOBE_SOLVERS_JOINT_ROWS_H_
#define TRILOBE_SOLVERS_JOINT_ROWS_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/folded_grid.h"
#include "trilobe/solvers/cell_sums.h"
#include "trilobe/solvers/normal_equations.h"

namespace trilobe {

// The part of H and J'r in which d, s, D or F take part, from one streaming pass over the rows
// (theta_h, theta_d) of a folded grid (docs/method.md).
//
// In a row and channel rho = sum_a x_a phi_a as in CellSums. A parameter of d, s, D or F moves it
// by known multiples v_a of the phi_a, so that two of them have the product v.A.v' with CellSums'
// A_ab = sum w phi_a phi_b. A node k of table t of G moves it by
//   X_t z_tk,   X_t = sum of x_m over the lobes m that t serves,
//   z_tk = (B_k(theta_i) G_t(theta_o) + G_t(theta_i) B_k(theta_o)) / (cos cos),
// so its product with the former needs only  C_a,tk = sum w phi_a z_tk  of the row, which is
// accumulated in the cache and spread over the matrix once a row. One more "phi", the residual r,
// gives the gradient of G, and the second derivatives of E beyond J'J: rho = s D F K is linear in
// each of s, D, F, so these are  b = sum w r K  times what is left of s D F when two are taken out,
// and  C_r,tk  times what is left when one is.
class JointRows {
 public:
  JointRows(const FoldedGrid& folded, const ModelSpec& spec);

  void Accumulate(const FactorModel& model, Hessian hessian, int num_threads);

  // The component of J'r of any parameter k.
  double GradientOf(int k) const;

  // For a parameter k of d, s, D, F: adds its products with the parameters k.. to row.
  // [num_parameters]
  void AddRow(int k, std::span<double> row) const;

 private:
  // Sums of one share of the rows.
  struct Share {
    std::vector<double> gradient;  // [num_parameters]
    std::vector<double> H;         // [parameters of d, s, D, F][num_parameters], from the diagonal
  };
  struct Workspace;

  void AddRowParameters(const FactorModel& model, Hessian hessian, int h, int d,
                        Share* share) const;
  void AddCrossProducts(const FactorModel& model, Hessian hessian,
                        const std::vector<std::vector<CatmullRom::Piece>>& G, int h, int d,
                        Workspace* workspace, Share* share) const;

  const FoldedGrid& folded_;
  const ModelSpec spec_;
  const int num_parameters_;
  const int num_row_parameters_;  // d, s, D, F
  CellSums cells_;
  std::vector<Share> shares_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_ROWS_H_
