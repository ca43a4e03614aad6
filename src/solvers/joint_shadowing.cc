#include "trilobe/solvers/joint_shadowing.h"

#include <algorithm>

#include "trilobe/base/multiversion.h"
#include "trilobe/base/parallel.h"

namespace trilobe {
namespace {

// Work is split into this many shares whatever the number of threads, so that sums always add up in
// the same order.
constexpr int kShares = 8;

// Samples per call of the kernels: their intermediate values stay in the first-level cache.
constexpr int kChunk = 256;

using Cubic = CatmullRom::Cubic;

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

// sum += w y_t y_u
TRILOBE_MULTIVERSION
void AddProducts(int size, const double* __restrict w, const double* y_t, const double* y_u,
                 double* __restrict sum) {
  for (int n = 0; n < size; ++n) sum[n] += w[n] * y_t[n] * y_u[n];
}

// Products of two polynomials in terms t^k (1 - t)^(3 - k) are ones in t^k (1 - t)^(6 - k).
std::array<double, SplineMoments::kSecond> Product(const Cubic& a, const Cubic& b) {
  std::array<double, SplineMoments::kSecond> product{};
  for (int k = 0; k < 4; ++k) {
    for (int l = 0; l < 4; ++l) product[k + l] += a[k] * b[l];
  }
  return product;
}

double Dot(const std::array<double, SplineMoments::kSecond>& a,
           const std::array<double, SplineMoments::kSecond>& b) {
  double sum = 0;
  for (int k = 0; k < SplineMoments::kSecond; ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace

// One knot interval: products of its four spline weights B and of the G tables, as polynomials.
struct JointShadowing::Side {
  std::array<std::array<Degree6, 4>, 4> BB;  // [node][node]
  std::vector<std::array<Degree6, 4>> BG;    // [table][node]
  std::vector<std::vector<Degree6>> GG;      // [table][table]
};

JointShadowing::JointShadowing(const SplineCells& samples, const ModelSpec& spec)
    : samples_(samples),
      spec_(spec),
      spline_(spec.g_nodes),
      size_(spec.num_tables(Factor::kG) * spec.g_nodes),
      shares_(kShares),
      curvature_shares_(kShares) {
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
}

std::vector<JointShadowing::Side> JointShadowing::MakeSides(const FactorModel& model) const {
  const int tables = spec_.num_tables(Factor::kG);
  std::vector<Side> sides(spec_.g_nodes - 1);
  for (int interval = 0; interval < spec_.g_nodes - 1; ++interval) {
    Side& side = sides[interval];
    const auto B = spline_.WeightPolynomials(interval);
    std::vector<Cubic> G(tables, Cubic{});
    for (int a = 0; a < 4; ++a) {
      const int node = interval - 1 + a;
      for (int b = 0; b < 4; ++b) side.BB[a][b] = Product(B[a], B[b]);
      if (node < 0 || node >= spec_.g_nodes) continue;
      for (int t = 0; t < tables; ++t) {
        for (int k = 0; k < 4; ++k) G[t][k] += B[a][k] * model.table(Factor::kG, t)[node];
      }
    }
    side.BG.resize(tables);
    side.GG.assign(tables, std::vector<Degree6>(tables));
    for (int t = 0; t < tables; ++t) {
      for (int a = 0; a < 4; ++a) side.BG[t][a] = Product(B[a], G[t]);
      for (int u = 0; u < tables; ++u) side.GG[t][u] = Product(G[t], G[u]);
    }
  }
  return sides;
}

// The moments of sum_C w y_t y_u in one cell, for each pair of tables.
void JointShadowing::SetMoments(const SplineCells::Cell& cell,
                                const std::vector<double>& amplitudes,
                                std::vector<SplineMoments>* moments) const {
  const size_t num_rows = static_cast<size_t>(samples_.grid.theta_h) * samples_.grid.theta_d;
  // By channel and the first lobe that a table serves there.
  double y[kChannels][kMaxLobes][kChunk], w_y_y[kChunk];
  std::ranges::fill(*moments, SplineMoments());
  for (int begin = cell.begin; begin < cell.end; begin += kChunk) {
    const int size = std::min(kChunk, cell.end - begin);
    for (int c = 0; c < kChannels; ++c) {
      for (int m = 0; m < spec_.lobes; ++m) {
        const int first = first_lobe_[spec_.table(Factor::kG, m, c)][c];
        if (first == m) std::fill_n(y[c][m], size, 0.0);
        AddAmplitude(size, &amplitudes[(static_cast<size_t>(c) * spec_.lobes + m) * num_rows],
                     &samples_.row[begin], &samples_.inverse_cosines[begin], y[c][first]);
      }
    }
    for (size_t p = 0; p < pairs_.size(); ++p) {
      const auto [t, u] = pairs_[p];
      std::fill_n(w_y_y, size, 0.0);
      for (int c = 0; c < kChannels; ++c) {
        const int m = first_lobe_[t][c], l = first_lobe_[u][c];
        if (m < 0 || l < 0) continue;
        AddProducts(size, &samples_.weight[c][begin], y[c][m], y[c][l], w_y_y);
      }
      AddSecondMoments(size, w_y_y, &samples_.t_i[begin], &samples_.t_o[begin], &(*moments)[p]);
    }
  }
}

// The moments of a cell contracted with the polynomials of its two sides. With i and o for the
// sides, the product of node a of table t and node b of table u is the moment of
//   B_a B_b(i) G_t G_u(o) + B_a G_u(i) G_t B_b(o) + G_t B_b(i) B_a G_u(o) + G_t G_u(i) B_a B_b(o),
// the nodes being the interval's own on the side where their B stands.
void JointShadowing::AddCell(const SplineCells::Cell& cell, const std::vector<Side>& sides,
                             const std::vector<SplineMoments>& moments,
                             std::vector<double>* sums) const {
  const Side &i = sides[cell.interval_i], &o = sides[cell.interval_o];
  for (size_t p = 0; p < pairs_.size(); ++p) {
    const auto [t, u] = pairs_[p];
    const SplineMoments& moment = moments[p];
    const auto over_o = [&moment](const Degree6& polynomial) {  // leaves one of theta_i
      Degree6 result{};
      for (int l = 0; l < SplineMoments::kSecond; ++l) {
        for (int k = 0; k < SplineMoments::kSecond; ++k) {
          result[k] += polynomial[l] * moment.second[l][k];
        }
      }
      return result;
    };
    const auto over_i = [&moment](const Degree6& polynomial) {  // leaves one of theta_o
      Degree6 result{};
      for (int l = 0; l < SplineMoments::kSecond; ++l) {
        for (int k = 0; k < SplineMoments::kSecond; ++k) {
          result[l] += moment.second[l][k] * polynomial[k];
        }
      }
      return result;
    };
    const auto add = [&, t = t, u = u](int node_t, int node_u, double value) {
      if (node_t < 0 || node_u < 0 || node_t >= spec_.g_nodes || node_u >= spec_.g_nodes) return;
      (*sums)[static_cast<size_t>(t * spec_.g_nodes + node_t) * size_ + u * spec_.g_nodes +
              node_u] += value;
    };
    const int first_i = cell.interval_i - 1, first_o = cell.interval_o - 1;
    const Degree6 GG_o = over_o(o.GG[t][u]), GG_i = over_i(i.GG[t][u]);
    std::array<Degree6, 4> BG_t, BG_u;
    for (int b = 0; b < 4; ++b) {
      BG_t[b] = over_o(o.BG[t][b]);
      BG_u[b] = over_o(o.BG[u][b]);
    }
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        add(first_i + a, first_i + b, Dot(i.BB[a][b], GG_o));
        add(first_o + a, first_o + b, Dot(o.BB[a][b], GG_i));
        add(first_i + a, first_o + b, Dot(i.BG[u][a], BG_t[b]));
        add(first_o + a, first_i + b, Dot(i.BG[t][b], BG_u[a]));
      }
    }
  }
}

// The moments of sum_C w (rho - rho*) y_t in one cell, for each table.
void JointShadowing::SetResidualMoments(const SplineCells::Cell& cell, const FactorModel& model,
                                        const std::vector<std::vector<CatmullRom::Piece>>& G,
                                        const std::vector<double>& amplitudes,
                                        std::vector<SplineMoments>* moments) const {
  const size_t num_rows = static_cast<size_t>(samples_.grid.theta_h) * samples_.grid.theta_d;
  const size_t tables = G.size();
  double y[kMaxLobes][kChunk], residual[kChunk], GG[kChunk];
  double w_r_y[kMaxLobes * kChannels][kChunk];
  std::ranges::fill(*moments, SplineMoments());
  for (int begin = cell.begin; begin < cell.end; begin += kChunk) {
    const int size = std::min(kChunk, cell.end - begin);
    for (size_t t = 0; t < tables; ++t) std::fill_n(w_r_y[t], size, 0.0);
    for (int c = 0; c < kChannels; ++c) {
      for (int n = 0; n < size; ++n) residual[n] = model.d()[c] - samples_.rho[c][begin + n];
      for (int m = 0; m < spec_.lobes; ++m) {
        const auto& of_table = G[spec_.table(Factor::kG, m, c)];
        std::fill_n(y[m], size, 0.0);
        AddAmplitude(size, &amplitudes[(static_cast<size_t>(c) * spec_.lobes + m) * num_rows],
                     &samples_.row[begin], &samples_.inverse_cosines[begin], y[m]);
        MultiplyReadings(size, of_table[cell.interval_i], of_table[cell.interval_o],
                         &samples_.t_i[begin], &samples_.t_o[begin], GG);
        for (int n = 0; n < size; ++n) residual[n] += y[m][n] * GG[n];
      }
      for (int m = 0; m < spec_.lobes; ++m) {
        AddProducts(size, &samples_.weight[c][begin], residual, y[m],
                    w_r_y[spec_.table(Factor::kG, m, c)]);
      }
    }
    for (size_t t = 0; t < tables; ++t) {
      AddFirstMoments(size, w_r_y[t], &samples_.t_i[begin], &samples_.t_o[begin], &(*moments)[t]);
    }
  }
}

void JointShadowing::AddCurvatureCell(const SplineCells::Cell& cell,
                                      const std::vector<SplineMoments>& moments,
                                      std::vector<double>* sums) const {
  const auto B_i = spline_.WeightPolynomials(cell.interval_i);
  const auto B_o = spline_.WeightPolynomials(cell.interval_o);
  for (size_t t = 0; t < moments.size(); ++t) {
    for (int a = 0; a < 4; ++a) {
      const int node_i = cell.interval_i - 1 + a;
      if (node_i < 0 || node_i >= spec_.g_nodes) continue;
      for (int b = 0; b < 4; ++b) {
        const int node_o = cell.interval_o - 1 + b;
        if (node_o < 0 || node_o >= spec_.g_nodes) continue;
        double sum = 0;
        for (int l = 0; l < 4; ++l) {
          for (int k = 0; k < 4; ++k) sum += B_o[b][l] * moments[t].first[l][k] * B_i[a][k];
        }
        const auto add = [&](int row, int column) {
          (*sums)[(t * spec_.g_nodes + row) * spec_.g_nodes + column] += sum;
        };
        add(node_i, node_o);
        add(node_o, node_i);
      }
    }
  }
}

void JointShadowing::Accumulate(const FactorModel& model, Hessian hessian, int num_threads) {
  const std::vector<Side> sides = MakeSides(model);
  const auto G = ShadowingPieces(model);
  const std::vector<double> amplitudes = LobeAmplitudes(samples_.grid, model);
  const int num_cells = static_cast<int>(samples_.cells.size());
  ParallelFor(kShares, num_threads, [&](int share) {
    std::vector<double>& sums = shares_[share];
    sums.assign(static_cast<size_t>(size_) * size_, 0.0);
    std::vector<SplineMoments> moments(pairs_.size()), residual_moments(G.size());
    for (int k = share; k < num_cells; k += kShares) {
      SetMoments(samples_.cells[k], amplitudes, &moments);
      AddCell(samples_.cells[k], sides, moments, &sums);
    }
    if (hessian == Hessian::kGaussNewton) return;
    std::vector<double>& curvature = curvature_shares_[share];
    curvature.assign(static_cast<size_t>(size_) * spec_.g_nodes, 0.0);
    for (int k = share; k < num_cells; k += kShares) {
      SetResidualMoments(samples_.cells[k], model, G, amplitudes, &residual_moments);
      AddCurvatureCell(samples_.cells[k], residual_moments, &curvature);
    }
  });
}

void JointShadowing::AddRow(int k, std::span<double> row) const {
  for (const std::vector<double>& sums : shares_) {
    const double* const of_share = &sums[static_cast<size_t>(k) * size_];
    for (int l = k; l < size_; ++l) row[l] += of_share[l];
  }
}

void JointShadowing::AddCurvatureRow(int k, std::span<double> row) const {
  const int first = k - k % spec_.g_nodes;  // node of the same table
  for (const std::vector<double>& sums : curvature_shares_) {
    const double* const of_share = &sums[static_cast<size_t>(k) * spec_.g_nodes];
    for (int l = k; l < first + spec_.g_nodes; ++l) row[l] += of_share[l - first];
  }
}

}  // namespace trilobe
