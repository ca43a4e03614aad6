#include "trilobe/solvers/shadowing_sums.h"

#include <algorithm>
#include <numeric>

#include "trilobe/base/multiversion.h"
#include "trilobe/base/parallel.h"

namespace trilobe {
namespace {

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

ShadowingSums::ShadowingSums(const FoldedGrid& folded, const ModelSpec& spec)
    : spec_(spec),
      theta_d_(folded.grid.theta_d),
      num_rows_(folded.num_rows()),
      quartics_(spec.g_nodes) {
  // Counting sort by cell; within a cell the samples keep their order.
  const int intervals = folded.g_nodes - 1;
  const auto key = [&](int n) { return folded.interval_i[n] * intervals + folded.interval_o[n]; };
  std::vector<int> begin(static_cast<size_t>(intervals) * intervals + 1, 0);
  for (int n = 0; n < folded.size(); ++n) ++begin[key(n) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (int cell = 0; cell < intervals * intervals; ++cell) {
    if (begin[cell] == begin[cell + 1]) continue;
    cells_.push_back({cell / intervals, cell % intervals, begin[cell], begin[cell + 1]});
  }
  std::vector<int> order(folded.size());
  for (int n = 0; n < folded.size(); ++n) order[begin[key(n)]++] = n;

  const auto sorted = [&order](const std::vector<double>& values) {
    std::vector<double> result(values.size());
    std::ranges::transform(order, result.begin(), [&values](int n) { return values[n]; });
    return result;
  };
  t_i_ = sorted(folded.t_i);
  t_o_ = sorted(folded.t_o);
  inverse_cosines_ = sorted(folded.inverse_cosines);
  for (int c = 0; c < kChannels; ++c) {
    weight_[c] = sorted(folded.weight[c]);
    rho_[c] = sorted(folded.rho[c]);
  }
  std::vector<int> row_of(folded.size());
  for (int row = 0; row < num_rows_; ++row) {
    std::fill(row_of.begin() + folded.row_begin[row], row_of.begin() + folded.row_begin[row + 1],
              row);
  }
  row_.resize(folded.size());
  std::ranges::transform(order, row_.begin(), [&row_of](int n) { return row_of[n]; });
  terms_.resize(cells_.size());
}

void ShadowingSums::ComputeAmplitudes(const FactorModel& model) {
  amplitudes_.resize(static_cast<size_t>(kChannels) * spec_.lobes * num_rows_);
  for (int c = 0; c < kChannels; ++c) {
    for (int m = 0; m < spec_.lobes; ++m) {
      double* const of_lobe = &amplitudes_[static_cast<size_t>(c * spec_.lobes + m) * num_rows_];
      const auto D = model.D(m, c), F = model.F(m, c);
      for (int row = 0; row < num_rows_; ++row) {
        of_lobe[row] = model.s(m)[c] * D[row / theta_d_] * F[row % theta_d_];
      }
    }
  }
}

SplineMoments ShadowingSums::CellMoments(const Cell& cell, const FactorModel& model, int table,
                                         const Pieces& G) const {
  SplineMoments moments;
  double K[kMaxLobes * kChannels][kChunk];
  double residual[kChunk], y[kChunk], w_y_r[kChunk], w_y_y[kChunk];
  for (int begin = cell.begin; begin < cell.end; begin += kChunk) {
    const int size = std::min(kChunk, cell.end - begin);
    const int* const row = &row_[begin];
    const double *const t_i = &t_i_[begin], *const t_o = &t_o_[begin];
    const double* const inverse_cosines = &inverse_cosines_[begin];
    for (size_t t = 0; t < G.size(); ++t) {
      CellShadowing(size, G[t][cell.interval_i], G[t][cell.interval_o], t_i, t_o, inverse_cosines,
                    K[t]);
    }
    std::fill_n(w_y_r, size, 0.0);
    std::fill_n(w_y_y, size, 0.0);
    for (int c = 0; c < kChannels; ++c) {
      const double* const rho = &rho_[c][begin];
      for (int n = 0; n < size; ++n) residual[n] = rho[n] - model.d()[c];
      std::fill_n(y, size, 0.0);
      for (int m = 0; m < spec_.lobes; ++m) {
        const double* const a = &amplitudes_[static_cast<size_t>(c * spec_.lobes + m) * num_rows_];
        const int t = spec_.table(Factor::kG, m, c);
        SubtractLobe(size, a, row, K[t], residual);
        if (t != table) continue;
        for (int n = 0; n < size; ++n) y[n] += a[row[n]];
      }
      AddWeights(size, &weight_[c][begin], y, inverse_cosines, residual, w_y_r, w_y_y);
    }
    AddSplineMoments(size, w_y_r, w_y_y, t_i, t_o, &moments);
  }
  return moments;
}

void ShadowingSums::Accumulate(const FactorModel& model, int table, int num_threads) {
  const Pieces G = ShadowingPieces(model);
  constexpr int kCellsPerItem = 32;
  const int num_cells = static_cast<int>(cells_.size());
  ParallelFor((num_cells + kCellsPerItem - 1) / kCellsPerItem, num_threads, [&](int item) {
    const int end = std::min((item + 1) * kCellsPerItem, num_cells);
    for (int k = item * kCellsPerItem; k < end; ++k) {
      const Cell& cell = cells_[k];
      quartics_.Transform(cell.interval_i, cell.interval_o, CellMoments(cell, model, table, G),
                          &terms_[k]);
    }
  });
  quartics_.Clear();
  for (int k = 0; k < num_cells; ++k) {
    quartics_.Add(cells_[k].interval_i, cells_[k].interval_o, terms_[k]);
  }
}

void ShadowingSums::UpdateAll(int num_threads,
                              const std::function<void(const FactorModel&)>& on_element,
                              FactorModel* model) {
  ComputeAmplitudes(*model);
  for (int t = 0; t < spec_.num_tables(Factor::kG); ++t) {
    Accumulate(*model, t, num_threads);
    const std::span<double> G = model->table(Factor::kG, t);
    for (int k = 0; k < spec_.g_nodes; ++k) {
      quartics_.UpdateNode(k, G);
      if (on_element) on_element(*model);
    }
  }
}

}  // namespace trilobe
