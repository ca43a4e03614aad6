#include "trilobe/solvers/joint_rows.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "trilobe/base/multiversion.h"
#include "trilobe/base/parallel.h"
#include "trilobe/model/catmull_rom.h"

namespace trilobe {
namespace {

// Work is split into this many shares whatever the number of threads, so that sums always add up in
// the same order.
constexpr int kShares = 8;
constexpr int kMaxBasis = 1 + kMaxLobes;
constexpr int kLanes = 8;

// The spline weights of four nodes as polynomials in Bernstein terms, term by term.
using WeightColumns = std::array<Lanes4, 4>;

WeightColumns Columns(const CatmullRom& spline, int interval) {
  const auto weights = spline.WeightPolynomials(interval);
  WeightColumns columns{};
  for (int k = 0; k < 4; ++k) {
    for (int a = 0; a < 4; ++a) columns[k][a] = weights[a][k];
  }
  return columns;
}

// B_a at t - 1/2 = v, a = 0..3.
TRILOBE_MULTIVERSION
void SplineWeights(int size, const std::array<WeightColumns, 3>& columns, int last_interval,
                   const int16_t* interval, const double* v, double* __restrict B) {
  for (int n = 0; n < size; ++n) {
    const WeightColumns& of = columns[interval[n] == 0 ? 0 : interval[n] == last_interval ? 2 : 1];
    const double t = 0.5 + v[n], u = 0.5 - v[n];
    const Lanes4 weights =
        u * u * u * of[0] + u * u * t * of[1] + u * t * t * of[2] + t * t * t * of[3];
    std::memcpy(B + 4 * n, &weights, sizeof(weights));
  }
}

// C[node][lane] += z_node q_lane for the four nodes of one side, where z = B H.
TRILOBE_MULTIVERSION
void AddCrossSums(int size, int lanes, const double* q, const int16_t* interval_i,
                  const int16_t* interval_o, const double* B_i, const double* B_o,
                  const double* H_i, const double* H_o, double* C) {
  for (int n = 0; n < size; ++n) {
    for (int lane = 0; lane < lanes; lane += kLanes) {
      Lanes8 q_n;
      std::memcpy(&q_n, q + static_cast<size_t>(n) * lanes + lane, sizeof(q_n));
      const auto add = [&](int interval, const double* B, double H) {
        const Lanes8 H_q = H * q_n;
        double* at = C + static_cast<size_t>(interval) * lanes + lane;
        for (int a = 0; a < 4; ++a, at += lanes) {
          Lanes8 sum;
          std::memcpy(&sum, at, sizeof(sum));
          sum += B[a] * H_q;
          std::memcpy(at, &sum, sizeof(sum));
        }
      };
      add(interval_i[n], B_i + 4 * n, H_i[n]);
      add(interval_o[n], B_o + 4 * n, H_o[n]);
    }
  }
}

TRILOBE_MULTIVERSION
void Axpy(int size, double a, const double* __restrict x, double* __restrict y) {
  for (int k = 0; k < size; ++k) y[k] += a * x[k];
}

// d, s, D and F as one row and channel sees them: d rho = sum_a v_a phi_a.
struct RowParameter {
  int index = 0;
  std::array<double, kMaxBasis> v{};
};

class RowParameters {
 public:
  RowParameters(const FactorModel& model, int h, int d, int c) {
    const ModelSpec& spec = model.spec();
    Find(c).v[0] = 1;
    for (int m = 0; m < spec.lobes; ++m) {
      const double s = model.s(m)[c], D = model.D(m, c)[h], F = model.F(m, c)[d];
      Find(kChannels * (1 + m) + c).v[1 + m] = D * F;
      Find(model.TableOffset(Factor::kD, spec.table(Factor::kD, m, c)) + h).v[1 + m] = s * F;
      Find(model.TableOffset(Factor::kF, spec.table(Factor::kF, m, c)) + d).v[1 + m] = s * D;
    }
  }
  const RowParameter* begin() const { return parameters_.data(); }
  const RowParameter* end() const { return parameters_.data() + count_; }

 private:
  RowParameter& Find(int index) {
    for (int k = 0; k < count_; ++k) {
      if (parameters_[k].index == index) return parameters_[k];
    }
    parameters_[count_].index = index;
    return parameters_[count_++];
  }

  int count_ = 0;
  std::array<RowParameter, 1 + 3 * kMaxLobes> parameters_{};
};

}  // namespace

// What one row needs, kept from row to row.
struct JointRows::Workspace {
  Workspace(const ModelSpec& spec, int max_row)
      : basis(1 + spec.lobes),
        lanes((kChannels * (basis + 1) + kLanes - 1) / kLanes * kLanes),
        padded_nodes(spec.g_nodes + 2) {
    const CatmullRom spline(spec.g_nodes);
    columns = {Columns(spline, 0), Columns(spline, 1), Columns(spline, spec.g_nodes - 2)};
    const size_t tables = spec.num_tables(Factor::kG);
    B_i.resize(4 * static_cast<size_t>(max_row));
    B_o.resize(B_i.size());
    q.assign(static_cast<size_t>(max_row) * lanes, 0.0);
    for (auto* of_tables : {&K, &H_i, &H_o}) {
      of_tables->assign(tables, std::vector<double>(max_row));
    }
    C.assign(tables, std::vector<double>(static_cast<size_t>(padded_nodes) * lanes));
    column.resize(padded_nodes);
  }

  int lane(int c, int a) const { return c * (basis + 1) + a; }  // a = basis: the residual

  int basis, lanes, padded_nodes;
  std::array<WeightColumns, 3> columns;
  std::vector<double> B_i, B_o;  // [max_row][4]
  std::vector<double> q;         // w phi_a, and w r. [max_row][lanes]
  // G(theta_i) G(theta_o) / (cos cos) and, for z, its other side: H_i goes with B(theta_i).
  std::vector<std::vector<double>> K, H_i, H_o;  // [tables][max_row]
  std::vector<std::vector<double>> C;            // [tables][padded_nodes][lanes]
  std::vector<double> column;                    // [padded_nodes]
};

JointRows::JointRows(const FoldedGrid& folded, const ModelSpec& spec)
    : folded_(folded),
      spec_(spec),
      num_parameters_(spec.num_parameters()),
      num_row_parameters_(num_parameters_ - spec.num_tables(Factor::kG) * spec.g_nodes),
      cells_(folded, spec),
      shares_(kShares) {}

void JointRows::AddRowParameters(const FactorModel& model, Hessian hessian, int h, int d,
                                 Share* share) const {
  const int basis = cells_.basis();
  for (int c = 0; c < kChannels; ++c) {
    const RowParameters parameters(model, h, d, c);
    const double* const b = cells_.b(h, d, c);
    const double* const A = cells_.A(h, d, c);
    for (const RowParameter& p : parameters) {
      std::array<double, kMaxBasis> A_v{};
      for (int a = 0; a < basis; ++a) {
        if (p.v[a] == 0) continue;
        share->gradient[p.index] -= p.v[a] * b[a];  // b is of the residual rho* - rho
        for (int e = 0; e < basis; ++e) A_v[e] += A[a * basis + e] * p.v[a];
      }
      double* const row = &share->H[static_cast<size_t>(p.index) * num_parameters_];
      for (const RowParameter& q : parameters) {
        if (q.index < p.index) continue;
        double sum = 0;
        for (int e = 0; e < basis; ++e) sum += q.v[e] * A_v[e];
        row[q.index] += sum;
      }
    }
    if (hessian == Hessian::kGaussNewton) continue;
    for (int m = 0; m < spec_.lobes; ++m) {
      const double r_K = -b[1 + m];
      const double s = model.s(m)[c], D = model.D(m, c)[h], F = model.F(m, c)[d];
      const int i_s = kChannels * (1 + m) + c;
      const int i_D = model.TableOffset(Factor::kD, spec_.table(Factor::kD, m, c)) + h;
      const int i_F = model.TableOffset(Factor::kF, spec_.table(Factor::kF, m, c)) + d;
      const auto at = [&](int row, int column) -> double& {
        return share->H[static_cast<size_t>(row) * num_parameters_ + column];
      };
      at(i_s, i_D) += r_K * F;
      at(i_s, i_F) += r_K * D;
      at(i_D, i_F) += r_K * s;
    }
  }
}

void JointRows::AddCrossProducts(const FactorModel& model, Hessian hessian,
                                 const std::vector<std::vector<CatmullRom::Piece>>& G, int h, int d,
                                 Workspace* workspace, Share* share) const {
  Workspace& of = *workspace;
  const int row = h * folded_.grid.theta_d + d;
  const int begin = folded_.row_begin[row], size = folded_.row_begin[row + 1] - begin;
  if (size == 0) return;
  const int16_t *const interval_i = &folded_.interval_i[begin], *const interval_o =
                                                                    &folded_.interval_o[begin];
  const double *const t_i = &folded_.t_i[begin], *const t_o = &folded_.t_o[begin];

  SplineWeights(size, of.columns, spec_.g_nodes - 2, interval_i, t_i, of.B_i.data());
  SplineWeights(size, of.columns, spec_.g_nodes - 2, interval_o, t_o, of.B_o.data());
  for (size_t t = 0; t < G.size(); ++t) {
    for (int n = 0; n < size; ++n) {
      const double inverse_cosines = folded_.inverse_cosines[begin + n];
      const double G_i = G[t][interval_i[n]](t_i[n]), G_o = G[t][interval_o[n]](t_o[n]);
      of.K[t][n] = G_i * G_o * inverse_cosines;
      of.H_i[t][n] = G_o * inverse_cosines;
      of.H_o[t][n] = G_i * inverse_cosines;
    }
  }
  std::array<std::array<double, kMaxLobes>, kChannels> x{};
  for (int c = 0; c < kChannels; ++c) {
    std::array<const double*, kMaxLobes> K{};
    for (int m = 0; m < spec_.lobes; ++m) {
      x[c][m] = model.s(m)[c] * model.D(m, c)[h] * model.F(m, c)[d];
      K[m] = of.K[spec_.table(Factor::kG, m, c)].data();
    }
    const double *const w = &folded_.weight[c][begin], *const rho = &folded_.rho[c][begin];
    for (int n = 0; n < size; ++n) {
      double* const q = &of.q[static_cast<size_t>(n) * of.lanes + of.lane(c, 0)];
      double residual = model.d()[c] - rho[n];
      q[0] = w[n];
      for (int m = 0; m < spec_.lobes; ++m) {
        residual += x[c][m] * K[m][n];
        q[1 + m] = w[n] * K[m][n];
      }
      q[of.basis] = w[n] * residual;
    }
  }

  // Padded nodes interval .. interval + 3 of both sides; theta_i >= theta_o.
  const int first = *std::min_element(interval_o, interval_o + size);
  const int last = *std::max_element(interval_i, interval_i + size) + 3;
  // Those that exist are padded nodes 1 .. g_nodes.
  const int lo = std::max(first, 1), hi = std::min(last, spec_.g_nodes);
  for (size_t t = 0; t < G.size(); ++t) {
    double* const C = of.C[t].data();
    std::fill(C + static_cast<size_t>(first) * of.lanes,
              C + static_cast<size_t>(last + 1) * of.lanes, 0.0);
    AddCrossSums(size, of.lanes, of.q.data(), interval_i, interval_o, of.B_i.data(), of.B_o.data(),
                 of.H_i[t].data(), of.H_o[t].data(), C);
    const int G_begin = model.TableOffset(Factor::kG, static_cast<int>(t)) + lo - 1;
    const auto channels = spec_.channels(Factor::kG, static_cast<int>(t));
    for (int c = channels.begin; c < channels.end; ++c) {
      double X = 0;
      for (int m = 0; m < spec_.lobes; ++m) {
        if (spec_.serves(Factor::kG, static_cast<int>(t), m, c)) X += x[c][m];
      }
      const int count = hi - lo + 1;
      const auto column = [&](int a) {
        for (int k = lo; k <= hi; ++k) {
          of.column[k] = C[static_cast<size_t>(k) * of.lanes + of.lane(c, a)];
        }
        return &of.column[lo];
      };
      const RowParameters parameters(model, h, d, c);
      const auto add = [&](const RowParameter& p, double scale, const double* of_column) {
        if (scale == 0) return;
        Axpy(count, scale, of_column,
             &share->H[static_cast<size_t>(p.index) * num_parameters_ + G_begin]);
      };
      for (int a = 0; a < of.basis; ++a) {
        const double* const of_basis = column(a);
        for (const RowParameter& p : parameters) add(p, X * p.v[a], of_basis);
      }
      const double* const of_residual = column(of.basis);
      Axpy(count, X, of_residual, &share->gradient[G_begin]);
      if (hessian == Hessian::kGaussNewton) continue;
      for (const RowParameter& p : parameters) {
        double dX = 0;  // d X / d p
        for (int m = 0; m < spec_.lobes; ++m) {
          if (spec_.serves(Factor::kG, static_cast<int>(t), m, c)) dX += p.v[1 + m];
        }
        add(p, dX, of_residual);
      }
    }
  }
}

void JointRows::Accumulate(const FactorModel& model, Hessian hessian, int num_threads) {
  cells_.Accumulate(model, num_threads);
  const auto G = ShadowingPieces(model);
  ParallelFor(kShares, num_threads, [&](int s) {
    Share& share = shares_[s];
    share.gradient.assign(num_parameters_, 0.0);
    share.H.assign(static_cast<size_t>(num_row_parameters_) * num_parameters_, 0.0);
    Workspace workspace(spec_, folded_.max_row_size());
    for (int h = s; h < folded_.grid.theta_h; h += kShares) {
      for (int d = 0; d < folded_.grid.theta_d; ++d) {
        AddRowParameters(model, hessian, h, d, &share);
        AddCrossProducts(model, hessian, G, h, d, &workspace, &share);
      }
    }
  });
}

double JointRows::GradientOf(int k) const {
  double sum = 0;
  for (const Share& share : shares_) sum += share.gradient[k];
  return sum;
}

void JointRows::AddRow(int k, std::span<double> row) const {
  for (const Share& share : shares_) {
    const double* const of_share = &share.H[static_cast<size_t>(k) * num_parameters_];
    for (int l = k; l < num_parameters_; ++l) row[l] += of_share[l];
  }
}

}  // namespace trilobe
