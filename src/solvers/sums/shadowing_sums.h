#ifndef TRILOBE_SOLVERS_SUMS_SHADOWING_SUMS_H_
#define TRILOBE_SOLVERS_SUMS_SHADOWING_SUMS_H_

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "core/algebra/element_step.h"
#include "solvers/sums/spline_moments.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/spline_cells.h"

namespace trilobe {

// E as a function of the nodes of one G table with all else held: an exact quartic in each node,
// from moments of the samples.
//
// In node weights B (B_a belongs to node a) the moments become
//   S_ab      = sum w y r   [B_a(theta_i) B_b(theta_o) + B_b(theta_i) B_a(theta_o)],
//   Q_(ac)(bd) = sum w y^2 [B_a B_c(theta_i) B_b B_d(theta_o) + B_b B_d(theta_i) B_a B_c(theta_o)],
// with a, c at most 3 nodes apart, and so b, d. Moving node k by delta changes a sample's value by
//   y (P1 delta + P2 delta^2),  P1 = B_k(theta_i) G(theta_o) + G(theta_i) B_k(theta_o),
//   P2 = B_k(theta_i) B_k(theta_o),
// which gives the quartic from V_cd = sum_b Q_(kc)(db) G_b, and the new S after the move:
//   c1 = -2 sum_d S_kd G_d,   c2 = sum_d V_kd G_d + sum_c V_ck G_c - S_kk,
//   c3 = 2 V_kk,              c4 = Q_(kk)(kk) / 2,
//   S_cd -= delta (V_cd + V_dc) + delta^2 Q_(kc)(kd).
class NodeQuartics {
 public:
  explicit NodeQuartics(int nodes);

  // Contribution of one pair of knot intervals to S and Q, in node weights, from its moments.
  // Local nodes a = 0..3 stand for interval - 1 + a; local pairs are (a, c), a <= c.
  static constexpr int kPairs = 10;
  struct CellTerms {
    double first[4][4];             // [node of theta_i][node of theta_o]
    double second[kPairs][kPairs];  // [pair of theta_i][pair of theta_o]
  };
  void Transform(int interval_i, int interval_o, const SplineMoments& moments,
                 CellTerms* terms) const;

  // Clear the sums over cells, and add a cell.
  void Clear();
  void Add(int interval_i, int interval_o, const CellTerms& terms);

  // Sets node k to the minimum of E. Nodes may be updated in any order.
  void UpdateNode(int k, std::span<double> G);

 private:
  // Nodes are shifted by one and padded at both ends, so that every interval has four.
  static constexpr int kBand = 4;  // pairs (a, a + 0..3)
  int PairIndex(int a, int c) const { return a < c ? a * kBand + (c - a) : c * kBand + (a - c); }
  double& S(int a, int b) { return S_[a * padded_ + b]; }
  double& Q(int p, int q) { return Q_[static_cast<size_t>(p) * pairs_ + q]; }

  int nodes_;
  int padded_;  // nodes + 2
  int pairs_;   // padded * kBand
  // Bernstein terms to node weights and to products of two, for the first, an inner, the last
  // interval.
  struct Basis {
    double first[4][SplineMoments::kFirst];
    double second[kPairs][SplineMoments::kSecond];
  };
  const Basis& BasisOf(int interval) const;
  std::array<Basis, 3> bases_;
  std::vector<double> S_;         // [padded][padded], symmetric
  std::vector<double> Q_;         // [pairs][pairs], symmetric
  std::vector<double> V_;         // [2 kBand - 1][padded]
  std::vector<double> padded_G_;  // [padded + kBand]
};

// Updates of G from moments of spline weights, exact for fixed d, s, D, F (docs/sums.md).
//
// With y = s D F / (cos cos), summed over the lobes that a table serves, and B_a the spline's
// weight of node a, a change of the table from G0 to G changes a sample's value by
//   y sum_ab B_a(theta_i) B_b(theta_o) (G_a G_b - G0_a G0_b).
// E therefore depends on the samples of a cell (knot interval of theta_i, knot interval of theta_o)
// only through  sum w y r B_a B_b  (r the residual)  and  sum w y^2 B_a B_b B_c B_d.  The weights
// are cubics in the place t within an interval, so these follow from 4 x 4 and 7 x 7 moments
//   sum_C w y r t_i^k t_o^l  and  sum_C w y^2 t_i^k t_o^l,
// which the pass over the samples adds up (SplineMoments). NodeQuartics does the rest.
class ShadowingSums {
 public:
  ShadowingSums(const SplineCells& samples, const ModelSpec& spec);

  // Sets the sums of one table of G by one pass over the samples.
  void Accumulate(const FactorModel& model, int table, int num_threads);

  // Sets every node of that table, in order, to the minimum of E with all else held. The sums must
  // be of this model and table. `on_element`, if set, sees the model after each.
  void UpdateTable(int table, const std::function<void(const FactorModel&)>& on_element,
                   FactorModel* model);

 private:
  using Pieces = std::vector<std::vector<CatmullRom::Piece>>;

  SplineMoments CellMoments(const SplineCells::Cell& cell, const FactorModel& model, int table,
                            const Pieces& G, const std::vector<double>& amplitudes) const;

  ModelSpec spec_;
  const SplineCells& samples_;
  std::vector<NodeQuartics::CellTerms> terms_;  // by cell
  NodeQuartics quartics_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_SHADOWING_SUMS_H_
