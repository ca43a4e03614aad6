#include "trilobe/model/objective/folded_grid.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/grid_cosines.h"
#include "model/objective/shadowing_pieces.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// The two bins that fold into one, by sample number; -1 where a bin is invalid.
struct Pair {
  int first = -1, second = -1;
  bool empty() const { return first < 0 && second < 0; }
};

class PairLookup {
 public:
  explicit PairLookup(const BrdfSamples& samples)
      : grid_(samples.grid), sample_of_bin_(samples.grid.size(), -1) {
    for (int j = 0; j < samples.size(); ++j) sample_of_bin_[samples.bins[j]] = j;
  }

  Pair At(int h, int d, int p) const {
    const int mirror = grid_.phi_d - 1 - p;
    Pair pair{sample_of_bin_[grid_.Index(h, d, p)], -1};
    if (mirror != p) pair.second = sample_of_bin_[grid_.Index(h, d, mirror)];
    return pair;
  }

 private:
  MerlGrid grid_;
  std::vector<int> sample_of_bin_;
};

}  // namespace

FoldedGrid Fold(const BrdfSamples& samples, int g_nodes, const Weighting& weighting,
                int num_threads) {
  FoldedGrid folded;
  const MerlGrid& grid = folded.grid = samples.grid;
  folded.g_nodes = g_nodes;
  const PairLookup lookup(samples);
  const int half = folded.max_row_size();

  folded.row_begin.assign(folded.num_rows() + 1, 0);
  for (int row = 0; row < folded.num_rows(); ++row) {
    for (int p = 0; p < half; ++p) {
      const bool empty = lookup.At(row / grid.theta_d, row % grid.theta_d, p).empty();
      folded.row_begin[row + 1] += empty ? 0 : 1;
    }
  }
  std::partial_sum(folded.row_begin.begin(), folded.row_begin.end(), folded.row_begin.begin());

  const int size = folded.size();
  folded.interval_i.resize(size);
  folded.interval_o.resize(size);
  folded.t_i.resize(size);
  folded.t_o.resize(size);
  folded.inverse_cosines.resize(size);
  for (int c = 0; c < kChannels; ++c) {
    folded.weight[c].resize(size);
    folded.rho[c].resize(size);
  }

  const CatmullRom spline(g_nodes);
  const GridCosines cosines(grid);
  const std::vector<CatmullRom::Piece> cosine = CosinePieces(spline);
  std::vector<double> constant(grid.theta_h, 0.0), energy(grid.theta_h, 0.0);
  ParallelFor(grid.theta_h, num_threads, [&](int h) {
    int n = folded.row_begin[h * grid.theta_d];
    for (int d = 0; d < grid.theta_d; ++d) {
      const double solid_angle = samples.counted ? 1 : grid.SolidAngle(h, d);
      for (int p = 0; p < half; ++p) {
        const Pair pair = lookup.At(h, d, p);
        if (pair.empty()) continue;
        const auto [cos_i, cos_o] = cosines(h, d, p);
        const CatmullRom::Location i = spline.Locate(std::acos(cos_i));
        const CatmullRom::Location o = spline.Locate(std::acos(cos_o));
        folded.interval_i[n] = static_cast<int16_t>(i.interval);
        folded.interval_o[n] = static_cast<int16_t>(o.interval);
        folded.t_i[n] = i.t - 0.5;
        folded.t_o[n] = o.t - 0.5;
        folded.inverse_cosines[n] =
            1 / (cosine[i.interval](i.t - 0.5) * cosine[o.interval](o.t - 0.5));
        const double multiplicity1 = pair.first < 0 ? 0 : samples.Multiplicity(pair.first);
        const double multiplicity2 = pair.second < 0 ? 0 : samples.Multiplicity(pair.second);
        // The mirror bin has theta_i and theta_o exchanged, and its own weight.
        const Rgb first = pair.first < 0 ? Rgb{} : samples.rho[pair.first];
        const Rgb second = pair.second < 0 ? Rgb{} : samples.rho[pair.second];
        const Rgb weight1 = weighting({first, {cos_i, cos_o}, solid_angle});
        const Rgb weight2 = weighting({second, {cos_o, cos_i}, solid_angle});
        for (int c = 0; c < kChannels; ++c) {
          const double rho1 = first[c], rho2 = second[c];
          const double w1 = multiplicity1 * weight1[c], w2 = multiplicity2 * weight2[c];
          const double w = w1 + w2;
          // rho1 plus a fraction of the difference: exact if both are equal.
          const double share = w > 0 ? w2 / w : 0;
          const double difference = rho2 - rho1;
          folded.weight[c][n] = w;
          folded.rho[c][n] = rho1 + share * difference;
          constant[h] += w1 * share * difference * difference;
          energy[h] += w1 * rho1 * rho1 + w2 * rho2 * rho2;
        }
        ++n;
      }
    }
  });
  folded.constant = std::accumulate(constant.begin(), constant.end(), 0.0);
  folded.measured_energy = std::accumulate(energy.begin(), energy.end(), 0.0);
  return folded;
}

void EvaluateShadowing(const FoldedGrid& folded, const std::vector<CatmullRom::Piece>& G, int begin,
                       int end, double* K) {
  for (int n = begin; n < end; ++n) {
    K[n - begin] = G[folded.interval_i[n]](folded.t_i[n]) * G[folded.interval_o[n]](folded.t_o[n]) *
                   folded.inverse_cosines[n];
  }
}

double FoldedValue(const FoldedGrid& folded, const FactorModel& model, int num_threads) {
  const ModelSpec& spec = model.spec();
  const auto G = ShadowingPieces(model);
  const int max_row = folded.max_row_size();
  std::vector<double> partial(folded.grid.theta_h, 0.0);
  ParallelFor(folded.grid.theta_h, num_threads, [&](int h) {
    std::vector<double> K(G.size() * max_row), rho(max_row);
    for (int d = 0; d < folded.grid.theta_d; ++d) {
      const int row = h * folded.grid.theta_d + d;
      const int begin = folded.row_begin[row], end = folded.row_begin[row + 1];
      const int size = end - begin;
      for (size_t t = 0; t < G.size(); ++t) {
        EvaluateShadowing(folded, G[t], begin, end, K.data() + t * max_row);
      }
      for (int c = 0; c < kChannels; ++c) {
        std::fill_n(rho.begin(), size, model.d()[c]);
        for (int m = 0; m < spec.lobes; ++m) {
          const double a = model.s(m)[c] * model.D(m, c)[h] * model.F(m, c)[d];
          const double* const Km = K.data() + spec.table(Factor::kG, m, c) * max_row;
          for (int n = 0; n < size; ++n) rho[n] += a * Km[n];
        }
        const double* const w = folded.weight[c].data() + begin;
        const double* const measured = folded.rho[c].data() + begin;
        double sum = 0;
#pragma omp simd reduction(+ : sum)
        for (int n = 0; n < size; ++n) {
          const double residual = measured[n] - rho[n];
          sum += w[n] * residual * residual;
        }
        partial[h] += sum;
      }
    }
  });
  return std::accumulate(partial.begin(), partial.end(), folded.constant);
}

CoverageByChannel FoldedCoverage(const FoldedGrid& folded) {
  const CatmullRom spline(folded.g_nodes);
  CoverageByChannel coverage;
  for (int c = 0; c < kChannels; ++c) {
    coverage[c].D = {std::vector<double>(folded.grid.theta_h, 0.0)};
    coverage[c].F.assign(folded.grid.theta_d, 0.0);
    coverage[c].G.assign(folded.g_nodes, 0.0);
  }
  for (int row = 0; row < folded.num_rows(); ++row) {
    const int h = row / folded.grid.theta_d, d = row % folded.grid.theta_d;
    for (int n = folded.row_begin[row]; n < folded.row_begin[row + 1]; ++n) {
      const Stencil stencils[] = {spline.StencilAt({folded.interval_i[n], folded.t_i[n] + 0.5}),
                                  spline.StencilAt({folded.interval_o[n], folded.t_o[n] + 0.5})};
      for (int c = 0; c < kChannels; ++c) {
        const double w = folded.weight[c][n];
        coverage[c].D[0][h] += w;
        coverage[c].F[d] += w;
        for (const Stencil& stencil : stencils) {
          for (int k = 0; k < stencil.size; ++k) {
            coverage[c].G[stencil.index[k]] += w * std::abs(stencil.weight[k]);
          }
        }
      }
    }
  }
  return coverage;
}

}  // namespace trilobe
