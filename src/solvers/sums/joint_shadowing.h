#ifndef TRILOBE_SOLVERS_SUMS_JOINT_SHADOWING_H_
#define TRILOBE_SOLVERS_SUMS_JOINT_SHADOWING_H_

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/model/objective/spline_cells.h"

namespace trilobe {

// The products of nodes of G in J'J, from one pass over the cells (knot interval of theta_i, knot
// interval of theta_o); see docs/sums.md.
//
// With y_t = sum s D F / (cos cos) over the lobes that table t serves, d rho / d node k of t is
//   y_t (B_k(theta_i) G_t(theta_o) + G_t(theta_i) B_k(theta_o)).
// In a cell B and G are cubics, so the products of two nodes of tables t, u need only the moments
// of degree 6 of  sum_C w y_t y_u  (SplineMoments::second): one set for each pair of tables. The
// second derivative of rho by two nodes of one table,
//   y_t (B_k(theta_i) B_l(theta_o) + B_l(theta_i) B_k(theta_o)),
// needs those of degree 3 of  sum_C w r y_t  (SplineMoments::first).
class JointShadowing {
 public:
  JointShadowing(const SplineCells& samples, const ModelSpec& spec);
  ~JointShadowing();

  // Sets the rows of G of the upper triangle (0 before) and the squared lengths of their columns.
  // The same bits for any number of threads.
  void Evaluate(const FactorModel& model, Hessian hessian, int num_threads, QuadraticModel* result);

 private:
  struct Side;
  struct Accumulator;
  struct Pass;

  std::vector<Side> MakeSides(const FactorModel& model) const;
  void SetMoments(const SplineCells::Cell& cell, const Pass& pass, Accumulator* accumulator) const;
  void AddCell(const SplineCells::Cell& cell, const Pass& pass, Accumulator* accumulator) const;
  void SetPair(size_t pair, const Pass& pass, QuadraticModel* result) const;

  const SplineCells& samples_;
  const ModelSpec spec_;
  const CatmullRom spline_;
  const int padded_nodes_;
  // Pairs of tables t <= u that serve some channel in common.
  std::vector<std::pair<int, int>> pairs_;
  std::vector<std::array<int, kChannels>> first_lobe_;  // that a table serves in a channel, or -1
  std::vector<int> first_cell_;                         // of each accumulator, and the end
  std::vector<std::unique_ptr<Accumulator>> accumulators_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_JOINT_SHADOWING_H_
