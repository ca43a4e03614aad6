#ifndef TRILOBE_SOLVERS_JOINT_SHADOWING_H_
#define TRILOBE_SOLVERS_JOINT_SHADOWING_H_

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/spline_cells.h"
#include "trilobe/solvers/normal_equations.h"
#include "trilobe/solvers/spline_moments.h"

namespace trilobe {

// The products in J'J of the nodes of G with each other, from one pass over the cells (knot
// interval of theta_i, knot interval of theta_o); see docs/method.md.
//
// With y_t = sum s D F / (cos cos) over the lobes that table t serves, a node k of t moves rho by
//   y_t (B_k(theta_i) G_t(theta_o) + G_t(theta_i) B_k(theta_o)).
// In a cell B and G are cubics, so the products of two nodes of tables t, u need only the moments
// of degree 6 of  sum_C w y_t y_u  (SplineMoments::second): one set for each pair of tables. The
// second derivative of rho by two nodes of one table,
//   y_t (B_k(theta_i) B_l(theta_o) + B_l(theta_i) B_k(theta_o)),
// needs those of degree 3 of  sum_C w r y_t  (SplineMoments::first).
class JointShadowing {
 public:
  JointShadowing(const SplineCells& samples, const ModelSpec& spec);

  void Accumulate(const FactorModel& model, Hessian hessian, int num_threads);

  // Adds the products of node k of all tables, table by table, with the nodes k.. to row.
  // [num_tables * g_nodes]
  void AddRow(int k, std::span<double> row) const;
  // The same for the second derivatives of rho, if Accumulate() was asked for them.
  void AddCurvatureRow(int k, std::span<double> row) const;

 private:
  using Degree6 = std::array<double, SplineMoments::kSecond>;
  struct Side;

  std::vector<Side> MakeSides(const FactorModel& model) const;  // [interval]
  void SetMoments(const SplineCells::Cell& cell, const std::vector<double>& amplitudes,
                  std::vector<SplineMoments>* moments) const;
  void SetResidualMoments(const SplineCells::Cell& cell, const FactorModel& model,
                          const std::vector<std::vector<CatmullRom::Piece>>& G,
                          const std::vector<double>& amplitudes,
                          std::vector<SplineMoments>* moments) const;
  void AddCell(const SplineCells::Cell& cell, const std::vector<Side>& sides,
               const std::vector<SplineMoments>& moments, std::vector<double>* sums) const;
  void AddCurvatureCell(const SplineCells::Cell& cell, const std::vector<SplineMoments>& moments,
                        std::vector<double>* sums) const;

  const SplineCells& samples_;
  const ModelSpec spec_;
  const CatmullRom spline_;
  const int size_;  // num_tables * g_nodes
  // Pairs of tables t <= u that serve some channel in common.
  std::vector<std::pair<int, int>> pairs_;
  std::vector<std::array<int, kChannels>> first_lobe_;  // that a table serves in a channel, or -1
  std::vector<std::vector<double>> shares_;             // [size_][size_], from the diagonal
  std::vector<std::vector<double>> curvature_shares_;   // [size_][g_nodes]: with the same table
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_SHADOWING_H_
