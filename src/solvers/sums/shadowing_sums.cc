#include "solvers/sums/shadowing_sums.h"

#include <algorithm>

#include "core/base/multiversion.h"
#include "model/objective/shadowing_pieces.h"
#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// The local pairs (a, c), in the order of CellTerms::second.
constexpr int kPairNodes[NodeQuartics::kPairs][2] = {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1},
                                                     {1, 2}, {1, 3}, {2, 2}, {2, 3}, {3, 3}};

// Samples per call of the kernels: their intermediate values stay in the first-level cache.
constexpr int kChunk = 256;

// K = G(theta_i) G(theta_o) / (cos cos) of samples in one cell.
TRILOBE_MULTIVERSION
void CellShadowing(int size, const CatmullRom::Piece& G_i, const CatmullRom::Piece& G_o,
                   const double* __restrict t_i, const double* __restrict t_o,
                   const double* __restrict inverse_cosines, double* __restrict K) {
  for (int n = 0; n < size; ++n) {
    K[n] = G_i(t_i[n]) * G_o(t_o[n]) * inverse_cosines[n];
  }
}

// residual -= a[row] K
TRILOBE_MULTIVERSION
void SubtractLobe(int size, const double* __restrict a, const int* __restrict row,
                  const double* __restrict K, double* __restrict residual) {
  for (int n = 0; n < size; ++n) residual[n] -= a[row[n]] * K[n];
}

// w y r and w y^2 of one channel, added to those of the others.
TRILOBE_MULTIVERSION
void AddWeights(int size, const double* __restrict w, const double* __restrict y,
                const double* __restrict inverse_cosines, const double* __restrict residual,
                double* __restrict w_y_r, double* __restrict w_y_y) {
  for (int n = 0; n < size; ++n) {
    const double y_n = y[n] * inverse_cosines[n];
    const double w_y = w[n] * y_n;
    w_y_r[n] += w_y * residual[n];
    w_y_y[n] += w_y * y_n;
  }
}

}  // namespace

NodeQuartics::NodeQuartics(int nodes)
    : nodes_(nodes),
      padded_(nodes + 2),
      pairs_(padded_ * kBand),
      S_(static_cast<size_t>(padded_) * padded_, 0.0),
      Q_(static_cast<size_t>(pairs_) * pairs_, 0.0),
      V_(static_cast<size_t>(2 * kBand - 1) * padded_, 0.0),
      padded_G_(padded_ + kBand, 0.0) {
  const CatmullRom spline(nodes);
  const int representatives[3] = {0, 1, nodes - 2};
  for (int i = 0; i < 3; ++i) {
    const auto weights = spline.WeightPolynomials(representatives[i]);
    Basis& basis = bases_[i];
    basis = {};
    for (int a = 0; a < 4; ++a) std::ranges::copy(weights[a], basis.first[a]);
    for (int p = 0; p < kPairs; ++p) {
      const auto& wa = weights[kPairNodes[p][0]];
      const auto& wc = weights[kPairNodes[p][1]];
      for (int k = 0; k < 4; ++k) {
        for (int l = 0; l < 4; ++l) basis.second[p][k + l] += wa[k] * wc[l];
      }
    }
  }
}

const NodeQuartics::Basis& NodeQuartics::BasisOf(int interval) const {
  return bases_[interval == 0 ? 0 : interval == nodes_ - 2 ? 2 : 1];
}

void NodeQuartics::Transform(int interval_i, int interval_o, const SplineMoments& moments,
                             CellTerms* terms) const {
  const Basis& basis_i = BasisOf(interval_i);
  const Basis& basis_o = BasisOf(interval_o);
  *terms = {};
  constexpr int kFirst = SplineMoments::kFirst, kSecond = SplineMoments::kSecond;
  for (int b = 0; b < 4; ++b) {
    double powers[kFirst] = {};  // of t_i, at node b of theta_o
    for (int l = 0; l < kFirst; ++l) {
      for (int k = 0; k < kFirst; ++k) powers[k] += basis_o.first[b][l] * moments.first[l][k];
    }
    for (int a = 0; a < 4; ++a) {
      for (int k = 0; k < kFirst; ++k) terms->first[a][b] += basis_i.first[a][k] * powers[k];
    }
  }
  for (int q = 0; q < kPairs; ++q) {
    double powers[SplineMoments::kSecondStride] = {};
    for (int l = 0; l < kSecond; ++l) {
      for (int k = 0; k < SplineMoments::kSecondStride; ++k) {
        powers[k] += basis_o.second[q][l] * moments.second[l][k];
      }
    }
    for (int p = 0; p < kPairs; ++p) {
      for (int k = 0; k < kSecond; ++k) terms->second[p][q] += basis_i.second[p][k] * powers[k];
    }
  }
}

void NodeQuartics::Clear() {
  std::ranges::fill(S_, 0.0);
  std::ranges::fill(Q_, 0.0);
}

void NodeQuartics::Add(int interval_i, int interval_o, const CellTerms& terms) {
  // Padded node numbers: local node a of an interval is interval + a.
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      S(interval_i + a, interval_o + b) += terms.first[a][b];
      S(interval_o + b, interval_i + a) += terms.first[a][b];
    }
  }
  for (int p = 0; p < kPairs; ++p) {
    const int global_p = PairIndex(interval_i + kPairNodes[p][0], interval_i + kPairNodes[p][1]);
    for (int q = 0; q < kPairs; ++q) {
      const int global_q = PairIndex(interval_o + kPairNodes[q][0], interval_o + kPairNodes[q][1]);
      Q(global_p, global_q) += terms.second[p][q];
      Q(global_q, global_p) += terms.second[p][q];
    }
  }
}

void NodeQuartics::UpdateNode(int k, std::span<double> G) {
  std::ranges::copy(G, padded_G_.begin() + 1);
  const std::vector<double>& g = padded_G_;
  const int node = k + 1;
  const int first = std::max(0, node - kBand + 1), last = std::min(padded_ - 1, node + kBand - 1);
  const auto V = [&](int c) { return V_.data() + static_cast<size_t>(c - first) * padded_; };

  for (int c = first; c <= last; ++c) {
    const double* const row = &Q(PairIndex(node, c), 0);
    double* const Vc = V(c);
    std::fill_n(Vc, padded_, 0.0);
    for (int d = 0; d < padded_; ++d) {
      Vc[d] += row[d * kBand] * g[d];
      for (int off = 1; off < kBand && d + off < padded_; ++off) {
        Vc[d] += row[d * kBand + off] * g[d + off];
        Vc[d + off] += row[d * kBand + off] * g[d];
      }
    }
  }
  double S_g = 0, V_g = 0;
  for (int d = 0; d < padded_; ++d) {
    S_g += S(node, d) * g[d];
    V_g += V(node)[d] * g[d];
  }
  for (int c = first; c <= last; ++c) V_g += V(c)[node] * g[c];
  const int kk = PairIndex(node, node);
  const ElementQuartic change{
      .c1 = -2 * S_g, .c2 = V_g - S(node, node), .c3 = 2 * V(node)[node], .c4 = Q(kk, kk) / 2};
  const double before = G[k];
  G[k] = BestElement(before, change);
  const double delta = G[k] - before;
  if (delta == 0) return;
  for (int c = first; c <= last; ++c) {
    for (int d = 0; d < padded_; ++d) {
      S(c, d) -= delta * V(c)[d];
      S(d, c) -= delta * V(c)[d];
    }
    for (int d = first; d <= last; ++d) {
      S(c, d) -= delta * delta * Q(PairIndex(node, c), PairIndex(node, d));
    }
  }
}

ShadowingSums::ShadowingSums(const SplineCells& samples, const ModelSpec& spec)
    : spec_(spec), samples_(samples), terms_(samples.cells.size()), quartics_(spec.g_axis.size) {}

SplineMoments ShadowingSums::CellMoments(const SplineCells::Cell& cell, const FactorModel& model,
                                         int table, const Pieces& G,
                                         const std::vector<double>& amplitudes) const {
  SplineMoments moments;
  const int num_rows = samples_.grid.theta_h * samples_.grid.theta_d;
  double K[kMaxLobes * kChannels][kChunk];
  double residual[kChunk], y[kChunk], w_y_r[kChunk], w_y_y[kChunk];
  for (int begin = cell.begin; begin < cell.end; begin += kChunk) {
    const int size = std::min(kChunk, cell.end - begin);
    const int* const row = &samples_.row[begin];
    const double *const t_i = &samples_.t_i[begin], *const t_o = &samples_.t_o[begin];
    const double* const inverse_cosines = &samples_.inverse_cosines[begin];
    for (size_t t = 0; t < G.size(); ++t) {
      CellShadowing(size, G[t][cell.interval_i], G[t][cell.interval_o], t_i, t_o, inverse_cosines,
                    K[t]);
    }
    std::fill_n(w_y_r, size, 0.0);
    std::fill_n(w_y_y, size, 0.0);
    for (int c = 0; c < kChannels; ++c) {
      const double* const rho = &samples_.rho[c][begin];
      for (int n = 0; n < size; ++n) residual[n] = rho[n] - model.d()[c];
      std::fill_n(y, size, 0.0);
      for (int m = 0; m < spec_.lobes; ++m) {
        const double* const a = &amplitudes[static_cast<size_t>(c * spec_.lobes + m) * num_rows];
        const int t = spec_.table(Factor::kG, m, c);
        SubtractLobe(size, a, row, K[t], residual);
        if (t != table) continue;
        for (int n = 0; n < size; ++n) y[n] += a[row[n]];
      }
      AddWeights(size, &samples_.weight[c][begin], y, inverse_cosines, residual, w_y_r, w_y_y);
    }
    AddSplineMoments(size, w_y_r, w_y_y, t_i, t_o, &moments);
  }
  return moments;
}

void ShadowingSums::Accumulate(const FactorModel& model, int table, int num_threads) {
  const Pieces G = ShadowingPieces(model);
  const std::vector<double> amplitudes = LobeAmplitudes(samples_.grid, model);
  const std::vector<SplineCells::Cell>& cells = samples_.cells;
  constexpr int kCellsPerItem = 32;
  const int num_cells = static_cast<int>(cells.size());
  ParallelFor((num_cells + kCellsPerItem - 1) / kCellsPerItem, num_threads, [&](int item) {
    const int end = std::min((item + 1) * kCellsPerItem, num_cells);
    for (int k = item * kCellsPerItem; k < end; ++k) {
      const SplineCells::Cell& cell = cells[k];
      quartics_.Transform(cell.interval_i, cell.interval_o,
                          CellMoments(cell, model, table, G, amplitudes), &terms_[k]);
    }
  });
  quartics_.Clear();
  for (int k = 0; k < num_cells; ++k) {
    quartics_.Add(cells[k].interval_i, cells[k].interval_o, terms_[k]);
  }
}

void ShadowingSums::UpdateTable(int table,
                                const std::function<void(const FactorModel&)>& on_element,
                                FactorModel* model) {
  const std::span<double> G = model->table(Factor::kG, table);
  for (int k = 0; k < spec_.g_axis.size; ++k) {
    quartics_.UpdateNode(k, G);
    if (on_element) on_element(*model);
  }
}

}  // namespace trilobe
