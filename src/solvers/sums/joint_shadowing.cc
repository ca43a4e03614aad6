#include "solvers/sums/joint_shadowing.h"

#include <algorithm>
#include <cstring>

#include "core/base/multiversion.h"
#include "model/objective/shadowing_pieces.h"
#include "solvers/sums/kernels.h"
#include "solvers/sums/spline_moments.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// Samples per call of the kernels: their intermediate values stay in the first-level cache.
constexpr int kChunk = 256;

constexpr int kSecond = SplineMoments::kSecond;
constexpr int kStride = SplineMoments::kSecondStride;

using Cubic = CatmullRom::Cubic;
// A polynomial of degree 6 in terms t^k (1 - t)^(6 - k).
using Degree6 = std::array<double, kStride>;

using Cubics = OfNodes<4>;
using Degree6s = OfNodes<kSecond>;

// y += a[row] / (cos cos)
TRILOBE_MULTIVERSION
void AddAmplitude(int size, const double* __restrict a, const int* __restrict row,
                  const double* __restrict inverse_cosines, double* __restrict y) {
  for (int n = 0; n < size; ++n) y[n] += a[row[n]] * inverse_cosines[n];
}

// GG = G(theta_i) G(theta_o)
TRILOBE_MULTIVERSION
void MultiplyReadings(int size, const CatmullRom::Piece& G_i, const CatmullRom::Piece& G_o,
                      const double* __restrict t_i, const double* __restrict t_o,
                      double* __restrict GG) {
  for (int n = 0; n < size; ++n) GG[n] = G_i(t_i[n]) * G_o(t_o[n]);
}

// sum += x y
TRILOBE_MULTIVERSION
void AddProduct(int size, const double* x, const double* y, double* __restrict sum) {
  for (int n = 0; n < size; ++n) sum[n] += x[n] * y[n];
}

// product = x y
TRILOBE_MULTIVERSION
void Multiply(int size, const double* x, const double* y, double* __restrict product) {
  for (int n = 0; n < size; ++n) product[n] = x[n] * y[n];
}

// Products of two cubics in terms t^k (1 - t)^(3 - k).
Degree6 Product(const Cubic& a, const Cubic& b) {
  Degree6 product{};
  for (int k = 0; k < 4; ++k) {
    for (int l = 0; l < 4; ++l) product[k + l] += a[k] * b[l];
  }
  return product;
}

// block[a] += sum_k left[k][a] right[k], the rows of the block `stride` apart.
template <int kTerms>
[[gnu::always_inline]] inline void AddBlock(const OfNodes<kTerms>& left,
                                            const OfNodes<kTerms>& right, size_t stride,
                                            double* block) {
  for (int a = 0; a < 4; ++a) {
    Lanes4 sum;
    std::memcpy(&sum, block + a * stride, sizeof(sum));
    for (int k = 0; k < kTerms; ++k) sum += left.term[k][a] * right.term[k];
    std::memcpy(block + a * stride, &sum, sizeof(sum));
  }
}

// Contracts the theta_o side of a moment with the polynomials of four nodes.
template <int kTerms, typename Moments>
[[gnu::always_inline]] inline OfNodes<kTerms> Contract(const Moments& moment,
                                                       const OfNodes<kTerms>& o) {
  OfNodes<kTerms> result;
  for (int k = 0; k < kTerms; ++k) {
    for (int l = 0; l < kTerms; ++l) result.term[k] += moment[l][k] * o.term[l];
  }
  return result;
}

// One pair of tables t, u in a cell: the products of a node on one side with a node on the other,
//   io[a][b] += (B_a G_u)(theta_i) (G_t B_b)(theta_o),
//   oi[a][b] += (B_a G_u)(theta_o) (G_t B_b)(theta_i),
// the latter alone where t = u, since io is its transpose; and, for products of two nodes of one
// side, what multiplies B_a B_b there,
//   i += G_t G_u (theta_o),   o += G_t G_u (theta_i).
struct PairOfSides {
  const Degree6s *BG_t_i, *BG_t_o, *BG_u_i, *BG_u_o;
  const Degree6 *GG_i, *GG_o;
};
TRILOBE_MULTIVERSION
void AddPair(const SplineMoments& moments, const PairOfSides& sides, size_t stride, double* io,
             double* oi, double* i, double* o) {
  const auto& moment = moments.second;
  AddBlock(Contract(moment, *sides.BG_u_o), *sides.BG_t_i, stride, oi);
  if (io != nullptr) AddBlock(*sides.BG_u_i, Contract(moment, *sides.BG_t_o), stride, io);
  for (int l = 0; l < kSecond; ++l) {
    double sum = 0;
    for (int k = 0; k < kSecond; ++k) {
      i[k] += (*sides.GG_o)[l] * moment[l][k];
      sum += moment[l][k] * (*sides.GG_i)[k];
    }
    o[l] += sum;
  }
}

// [a][b] += B_a(theta_o) B_b(theta_i)
TRILOBE_MULTIVERSION
void AddCurvature(const SplineMoments& moments, const Cubics& B_i, const Cubics& B_o, size_t stride,
                  double* oi) {
  AddBlock(Contract(moments.first, B_o), B_i, stride, oi);
}

}  // namespace

// One knot interval: its four spline weights B, and products of them and of the G tables.
struct JointShadowing::Side {
  Cubics B;
  std::array<Degree6s, 4> BB;  // [node]
  std::vector<Degree6s> BG;    // [table]
  std::vector<Degree6> GG;     // [pair]
};

// Data that all cells share in one pass over them.
struct JointShadowing::Pass {
  const FactorModel& model;
  Hessian hessian;
  std::vector<std::vector<CatmullRom::Piece>> G;
  std::vector<double> amplitudes;
  std::vector<Side> sides;  // [interval]
};

struct JointShadowing::Accumulator {
  Accumulator(size_t pairs, size_t tables, size_t padded_nodes)
      : moments(pairs),
        residual_moments(tables),
        across(pairs * padded_nodes * padded_nodes),
        along(pairs * padded_nodes * kStride),
        curvature(tables * padded_nodes * padded_nodes),
        w_y_y(pairs * kChunk),
        GG(tables * kChunk),
        w_r_y(tables * kChunk) {}

  void Clear() {
    for (auto* sums : {&across, &along, &curvature}) std::ranges::fill(*sums, 0.0);
  }

  // Sums of one cell.
  std::vector<SplineMoments> moments, residual_moments;  // [pair], [table]
  // Sums of all cells. Nodes are those of one table, then of the other, numbered from -1.
  std::vector<double> across;     // [pair][padded_nodes][padded_nodes]; half of those with t = u
  std::vector<double> along;      // what multiplies B B. [pair][interval][kStride]
  std::vector<double> curvature;  // half. [table][padded_nodes][padded_nodes]
  // Values of one chunk of samples, in one channel; by the first lobe that a table serves there.
  double y[kMaxLobes][kChunk], w_y[kMaxLobes][kChunk], residual[kChunk];
  std::vector<double> w_y_y, GG, w_r_y;  // [pair][kChunk], [table][kChunk]
};

JointShadowing::JointShadowing(const SplineCells& samples, const ModelSpec& spec)
    : samples_(samples),
      spec_(spec),
      spline_(spec.g_axis.size),
      padded_nodes_(spec.g_axis.size + 2) {
  const int tables = spec.num_tables(Factor::kG);
  for (int t = 0; t < tables; ++t) {
    for (int u = t; u < tables; ++u) {
      const auto a = spec.channels(Factor::kG, t), b = spec.channels(Factor::kG, u);
      if (std::max(a.begin, b.begin) < std::min(a.end, b.end)) pairs_.emplace_back(t, u);
    }
  }
  first_lobe_.assign(tables, {-1, -1, -1});
  for (int m = spec.lobes - 1; m >= 0; --m) {
    for (int c = 0; c < kChannels; ++c) first_lobe_[spec.table(Factor::kG, m, c)][c] = m;
  }
  // Each accumulator gets an equal number of samples, in one piece.
  first_cell_.assign(1, 0);
  const int count = NumAccumulators(static_cast<int>(samples.row.size()));
  for (int k = 0; k < count; ++k) {
    const size_t end = samples.row.size() * (k + 1) / count;
    first_cell_.push_back(static_cast<int>(std::ranges::count_if(
        samples.cells, [end](const auto& cell) { return static_cast<size_t>(cell.begin) < end; })));
    accumulators_.push_back(std::make_unique<Accumulator>(pairs_.size(), tables, padded_nodes_));
  }
}

JointShadowing::~JointShadowing() = default;

std::vector<JointShadowing::Side> JointShadowing::MakeSides(const FactorModel& model) const {
  const int tables = spec_.num_tables(Factor::kG);
  std::vector<Side> sides(spec_.g_axis.size - 1);
  const auto set = [](const Degree6& polynomial, int node, Degree6s* products) {
    for (int k = 0; k < kSecond; ++k) products->term[k][node] = polynomial[k];
  };
  for (int interval = 0; interval < spec_.g_axis.size - 1; ++interval) {
    Side& side = sides[interval];
    const auto B = spline_.WeightPolynomials(interval);
    side.B = WeightsOfNodes(spline_, interval);
    std::vector<Cubic> G(tables, Cubic{});
    for (int a = 0; a < 4; ++a) {
      const int node = interval - 1 + a;
      for (int b = 0; b < 4; ++b) set(Product(B[a], B[b]), b, &side.BB[a]);
      if (node < 0 || node >= spec_.g_axis.size) continue;
      for (int t = 0; t < tables; ++t) {
        for (int k = 0; k < 4; ++k) G[t][k] += B[a][k] * model.table(Factor::kG, t)[node];
      }
    }
    side.BG.resize(tables);
    for (int t = 0; t < tables; ++t) {
      for (int a = 0; a < 4; ++a) set(Product(B[a], G[t]), a, &side.BG[t]);
    }
    for (const auto& [t, u] : pairs_) side.GG.push_back(Product(G[t], G[u]));
  }
  return sides;
}

// The moments of sum_C w y_t y_u in one cell for each pair of tables and, for second derivatives,
// those of sum_C w (rho - rho*) y_t for each table.
void JointShadowing::SetMoments(const SplineCells::Cell& cell, const Pass& pass,
                                Accumulator* accumulator) const {
  const size_t num_rows = static_cast<size_t>(samples_.grid.theta_h) * samples_.grid.theta_d;
  const int tables = static_cast<int>(pass.G.size());
  Accumulator& sums = *accumulator;
  std::ranges::fill(sums.moments, SplineMoments());
  std::ranges::fill(sums.residual_moments, SplineMoments());
  const bool curvature = pass.hessian == Hessian::kNewton;
  for (int begin = cell.begin; begin < cell.end; begin += kChunk) {
    const int size = std::min(kChunk, cell.end - begin);
    const double *const t_i = &samples_.t_i[begin], *const t_o = &samples_.t_o[begin];
    for (size_t p = 0; p < pairs_.size(); ++p) std::fill_n(&sums.w_y_y[p * kChunk], size, 0.0);
    for (int t = 0; t < tables; ++t) std::fill_n(&sums.w_r_y[t * size_t{kChunk}], size, 0.0);
    for (int t = 0; t < tables && curvature; ++t) {
      MultiplyReadings(size, pass.G[t][cell.interval_i], pass.G[t][cell.interval_o], t_i, t_o,
                       &sums.GG[static_cast<size_t>(t) * kChunk]);
    }
    for (int c = 0; c < kChannels; ++c) {
      for (int m = 0; m < spec_.lobes; ++m) {
        const int first = first_lobe_[spec_.table(Factor::kG, m, c)][c];
        if (first == m) std::fill_n(sums.y[m], size, 0.0);
        AddAmplitude(size, &pass.amplitudes[(static_cast<size_t>(c) * spec_.lobes + m) * num_rows],
                     &samples_.row[begin], &samples_.inverse_cosines[begin], sums.y[first]);
      }
      if (curvature) {
        for (int n = 0; n < size; ++n) {
          sums.residual[n] = pass.model.d()[c] - samples_.rho[c][begin + n];
        }
      }
      for (int t = 0; t < tables; ++t) {
        const int m = first_lobe_[t][c];
        if (m < 0) continue;
        Multiply(size, &samples_.weight[c][begin], sums.y[m], sums.w_y[m]);
        if (curvature) {
          AddProduct(size, sums.y[m], &sums.GG[static_cast<size_t>(t) * kChunk], sums.residual);
        }
      }
      for (size_t p = 0; p < pairs_.size(); ++p) {
        const int m = first_lobe_[pairs_[p].first][c], l = first_lobe_[pairs_[p].second][c];
        if (m >= 0 && l >= 0) AddProduct(size, sums.w_y[m], sums.y[l], &sums.w_y_y[p * kChunk]);
      }
      for (int t = 0; t < tables && curvature; ++t) {
        const int m = first_lobe_[t][c];
        if (m < 0) continue;
        AddProduct(size, sums.w_y[m], sums.residual, &sums.w_r_y[static_cast<size_t>(t) * kChunk]);
      }
    }
    AddSecondMoments(size, static_cast<int>(pairs_.size()), kChunk, sums.w_y_y.data(), t_i, t_o,
                     sums.moments.data());
    for (int t = 0; t < tables && curvature; ++t) {
      AddFirstMoments(size, &sums.w_r_y[static_cast<size_t>(t) * kChunk], t_i, t_o,
                      &sums.residual_moments[t]);
    }
  }
}

// The moments of a cell contracted with the polynomials of its two sides.
void JointShadowing::AddCell(const SplineCells::Cell& cell, const Pass& pass,
                             Accumulator* accumulator) const {
  const Side &i = pass.sides[cell.interval_i], &o = pass.sides[cell.interval_o];
  const size_t nodes = padded_nodes_;
  const size_t at_oi = cell.interval_o * nodes + cell.interval_i;
  const size_t at_io = cell.interval_i * nodes + cell.interval_o;
  for (size_t p = 0; p < pairs_.size(); ++p) {
    const auto [t, u] = pairs_[p];
    double* const across = &accumulator->across[p * nodes * nodes];
    double* const along = &accumulator->along[p * nodes * kStride];
    AddPair(accumulator->moments[p], {&i.BG[t], &o.BG[t], &i.BG[u], &o.BG[u], &i.GG[p], &o.GG[p]},
            nodes, t == u ? nullptr : across + at_io, across + at_oi,
            along + cell.interval_i * kStride, along + cell.interval_o * kStride);
  }
  if (pass.hessian == Hessian::kGaussNewton) return;
  for (size_t t = 0; t < pass.G.size(); ++t) {
    AddCurvature(accumulator->residual_moments[t], i.B, o.B, nodes,
                 &accumulator->curvature[t * nodes * nodes + at_oi]);
  }
}

// Hands over what all cells added up for one pair of tables.
void JointShadowing::SetPair(size_t pair, const Pass& pass, QuadraticModel* result) const {
  const auto [t, u] = pairs_[pair];
  const size_t nodes = padded_nodes_, size = nodes * nodes;
  const bool curvature = t == u && pass.hessian == Hessian::kNewton;
  double* const across = &accumulators_[0]->across[pair * size];
  double* const along = &accumulators_[0]->along[pair * nodes * kStride];
  double* const curvature_sums = &accumulators_[0]->curvature[t * size];
  for (size_t s = 1; s < accumulators_.size(); ++s) {
    AddTo(size, &accumulators_[s]->across[pair * size], across);
    AddTo(nodes * kStride, &accumulators_[s]->along[pair * nodes * kStride], along);
    if (curvature) AddTo(size, &accumulators_[s]->curvature[t * size], curvature_sums);
  }
  for (size_t interval = 0; interval < pass.sides.size(); ++interval) {
    for (int a = 0; a < 4; ++a) {
      const Degree6s& BB = pass.sides[interval].BB[a];
      Lanes4 sum = {};
      for (int k = 0; k < kSecond; ++k) sum += along[interval * kStride + k] * BB.term[k];
      if (t == u) sum *= 0.5;
      for (int b = 0; b < 4; ++b) across[(interval + a) * nodes + interval + b] += sum[b];
    }
  }
  const size_t n = result->gradient.size();
  const int first_t = pass.model.TableOffset(Factor::kG, t);
  const int first_u = pass.model.TableOffset(Factor::kG, u);
  for (int k = 0; k < spec_.g_axis.size; ++k) {
    double* const row = &result->H[(first_t + k) * n + first_u];
    const auto set = [&, same = t == u](const double* sums, int l) {
      row[l] += sums[(1 + k) * nodes + 1 + l];
      if (same) row[l] += sums[(1 + l) * nodes + 1 + k];
    };
    for (int l = t == u ? k : 0; l < spec_.g_axis.size; ++l) set(across, l);
    if (t == u) result->squared_lengths[first_t + k] = row[k];
    if (!curvature) continue;
    for (int l = k; l < spec_.g_axis.size; ++l) set(curvature_sums, l);
  }
}

void JointShadowing::Evaluate(const FactorModel& model, Hessian hessian, int num_threads,
                              QuadraticModel* result) {
  const Pass pass{model, hessian, ShadowingPieces(model), LobeAmplitudes(samples_.grid, model),
                  MakeSides(model)};
  ParallelFor(static_cast<int>(accumulators_.size()), num_threads, [&](int s) {
    Accumulator* const accumulator = accumulators_[s].get();
    accumulator->Clear();
    for (int k = first_cell_[s]; k < first_cell_[s + 1]; ++k) {
      SetMoments(samples_.cells[k], pass, accumulator);
      AddCell(samples_.cells[k], pass, accumulator);
    }
  });
  ParallelFor(static_cast<int>(pairs_.size()), num_threads,
              [&](int pair) { SetPair(pair, pass, result); });
}

}  // namespace trilobe
