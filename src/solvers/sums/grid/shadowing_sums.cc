#include "solvers/sums/grid/shadowing_sums.h"

#include <algorithm>

#include "core/base/multiversion.h"
#include "model/lobes/shadowing_pieces.h"
#include "trilobe/core/system/parallel.h"

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
