#include "trilobe/solvers/joint_rows.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>

#include "trilobe/base/multiversion.h"
#include "trilobe/base/parallel.h"
#include "trilobe/model/catmull_rom.h"

namespace trilobe {
namespace {

// Work is split into this many shares whatever the number of threads, so that sums always add up in
// the same order.
constexpr int kShares = 8;
constexpr int kBatch = 8;  // samples; rows are padded to whole batches, with weight 0

using Pieces = std::vector<std::vector<CatmullRom::Piece>>;

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

// One lobe of a row and channel, and the lines (see Layout) of its s, D and F.
struct LobeOfRow {
  double x = 0, DF = 0, sF = 0, sD = 0;  // x = s D F and what it is multiplied with, of each
  const double* K = nullptr;             // [size]
  bool served = false;                   // by the table of G in question
  int s_line = 0, D_line = 0, F_line = 0;
};
using LobesOfRow = std::array<LobeOfRow, kMaxLobes>;

// Adds one channel's q to those of each sample. [lines][line_size]
TRILOBE_MULTIVERSION
void AddChannel(int size, double X, const double* __restrict w, const double* __restrict w_residual,
                int lobes, const LobesOfRow& lobe, bool curvature, int d_line, int gradient_line,
                int line_size, double* __restrict q) {
  for (int n = 0; n < size; n += kBatch) {
    const auto load = [n](const double* from, Lanes8* value) {
      std::memcpy(value, from + n, sizeof(*value));
    };
    const auto add = [&](int line, const Lanes8& value) {
      double* const to = q + static_cast<size_t>(line) * line_size;
      Lanes8 sum;
      load(to, &sum);
      sum += value;
      std::memcpy(to + n, &sum, sizeof(sum));
    };
    Lanes8 X_w, residual, u;
    load(w, &X_w);
    load(w_residual, &residual);
    X_w *= X;
    add(d_line, X_w);
    add(gradient_line, X * residual);
    for (int m = 0; m < lobes; ++m) {
      load(lobe[m].K, &u);
      u *= X_w;
      if (curvature && lobe[m].served) u += residual;
      add(lobe[m].s_line, lobe[m].DF * u);
      add(lobe[m].D_line, lobe[m].sF * u);
      add(lobe[m].F_line, lobe[m].sD * u);
    }
  }
}

// Some lines: their q for each sample, and the sums that these go to.
struct Lines {
  int count = 0;
  const double* q = nullptr;  // [count][line_size]
  double* sums = nullptr;     // [count][padded_nodes]
};

// sums += q z for the four nodes of both sides of each sample, where z = B H.
TRILOBE_MULTIVERSION
void AddCrossSums(int size, const int16_t* interval_i, const int16_t* interval_o, const double* B_i,
                  const double* B_o, const double* H_i, const double* H_o, int line_size,
                  int padded_nodes, const std::array<Lines, 2>& blocks) {
  for (int n = 0; n < size; ++n) {
    Lanes4 z_i, z_o;
    std::memcpy(&z_i, B_i + 4 * n, sizeof(z_i));
    std::memcpy(&z_o, B_o + 4 * n, sizeof(z_o));
    z_i *= H_i[n];
    z_o *= H_o[n];
    for (const Lines& block : blocks) {
      double *at_i = block.sums + interval_i[n], *at_o = block.sums + interval_o[n];
      const double* q = block.q + n;
      for (int line = 0; line < block.count; ++line) {
        Lanes4 sum;
        std::memcpy(&sum, at_i, sizeof(sum));
        sum += *q * z_i;
        std::memcpy(at_i, &sum, sizeof(sum));
        std::memcpy(&sum, at_o, sizeof(sum));
        sum += *q * z_o;
        std::memcpy(at_o, &sum, sizeof(sum));
        at_i += padded_nodes;
        at_o += padded_nodes;
        q += line_size;
      }
    }
  }
}

TRILOBE_MULTIVERSION
void Add(int size, const double* __restrict x, double* __restrict y) {
  for (int k = 0; k < size; ++k) y[k] += x[k];
}

}  // namespace

// What lies where in the sums of a share. A row has "near" parameters, those of all rows of its
// theta_h, numbered d, s as in a model, then one of each table of D; and "far" ones, of all rows of
// its theta_d: one of each table of F. Their sums with a table of G, of which they must serve some
// channel in common, are one line each; a last near line has the gradient of G.
class JointRows::Layout {
 public:
  struct OfTable {
    std::vector<int> near, far;            // parameter of each line
    std::vector<int> near_line, far_line;  // line of each parameter; none: -1
    int near_begin = 0, far_begin = 0;     // first line, among those of all tables
    int gradient_line() const { return static_cast<int>(near.size()); }
    int num_near_lines() const { return gradient_line() + 1; }
  };

  Layout(const ModelSpec& of_model, int max_row)
      : spec(of_model),
        first_D(kChannels * (1 + spec.lobes)),
        num_near(first_D + spec.num_tables(Factor::kD)),
        num_far(spec.num_tables(Factor::kF)),
        padded_nodes(spec.g_nodes + 2),
        line_size((max_row + kBatch - 1) / kBatch * kBatch),
        tables(spec.num_tables(Factor::kG)) {
    const CatmullRom spline(spec.g_nodes);
    columns = {Columns(spline, 0), Columns(spline, 1), Columns(spline, spec.g_nodes - 2)};
    for (int t = 0; t < static_cast<int>(tables.size()); ++t) {
      OfTable& table = tables[t];
      table.near_line.assign(num_near, -1);
      table.far_line.assign(num_far, -1);
      const auto [begin, end] = spec.channels(Factor::kG, t);
      for (int c = begin; c < end; ++c) {
        table.near_line[c] = 0;
        for (int m = 0; m < spec.lobes; ++m) {
          table.near_line[s(m, c)] = table.near_line[D(m, c)] = table.far_line[F(m, c)] = 0;
        }
      }
      const auto number = [](std::vector<int>* line_of, std::vector<int>* lines) {
        for (int k = 0; k < static_cast<int>(line_of->size()); ++k) {
          if ((*line_of)[k] < 0) continue;
          (*line_of)[k] = static_cast<int>(lines->size());
          lines->push_back(k);
        }
      };
      number(&table.near_line, &table.near);
      number(&table.far_line, &table.far);
      table.near_begin = num_near_lines;
      table.far_begin = num_far_lines;
      num_near_lines += table.num_near_lines();
      num_far_lines += static_cast<int>(table.far.size());
      max_lines = std::max(max_lines, table.num_near_lines() + static_cast<int>(table.far.size()));
    }
  }

  // Numbers of parameters; F's is far.
  static int s(int m, int c) { return kChannels * (1 + m) + c; }
  int D(int m, int c) const { return first_D + spec.table(Factor::kD, m, c); }
  int F(int m, int c) const { return spec.table(Factor::kF, m, c); }

  const ModelSpec spec;
  const int first_D, num_near, num_far, padded_nodes, line_size;
  int num_near_lines = 0, num_far_lines = 0, max_lines = 0;
  std::vector<OfTable> tables;
  std::array<WeightColumns, 3> columns;
};

struct JointRows::Share {
  explicit Share(const Layout& layout, int theta_d)
      : near_H(static_cast<size_t>(layout.num_near) * layout.num_near),
        near_gradient(layout.num_near),
        near_G(static_cast<size_t>(layout.num_near_lines) * layout.padded_nodes),
        far_H(static_cast<size_t>(theta_d) * (layout.num_near + layout.num_far) * layout.num_far),
        far_gradient(static_cast<size_t>(theta_d) * layout.num_far),
        far_G(static_cast<size_t>(theta_d) * layout.num_far_lines * layout.padded_nodes),
        B_i(4 * static_cast<size_t>(layout.line_size)),
        B_o(B_i.size()),
        q(static_cast<size_t>(layout.max_lines) * layout.line_size) {
    for (auto* of_channels : {&w, &w_residual}) {
      of_channels->fill(std::vector<double>(layout.line_size));
    }
    for (auto* of_tables : {&K, &H_i, &H_o}) {
      of_tables->assign(layout.tables.size(), std::vector<double>(layout.line_size));
    }
  }

  void Clear() {
    for (auto* sums : {&near_H, &near_gradient, &near_G, &far_H, &far_gradient, &far_G}) {
      std::ranges::fill(*sums, 0.0);
    }
  }

  double* FarH(const Layout& layout, int d) {
    return far_H.data() +
           static_cast<size_t>(d) * (layout.num_near + layout.num_far) * layout.num_far;
  }

  double* NearG(const Layout& layout, int line) {
    return near_G.data() + static_cast<size_t>(line) * layout.padded_nodes;
  }
  double* FarG(const Layout& layout, int d, int line) {
    return far_G.data() +
           (static_cast<size_t>(d) * layout.num_far_lines + line) * layout.padded_nodes;
  }

  std::vector<double> near_H;         // [near][near], from the diagonal
  std::vector<double> near_gradient;  // [near]
  std::vector<double> near_G;         // [near lines][padded_nodes]
  std::vector<double> far_H;          // [theta_d][near, then far][far], from the diagonal
  std::vector<double> far_gradient;   // [theta_d][far]
  std::vector<double> far_G;          // [theta_d][far lines][padded_nodes]

  // Of one row. [..][line_size]
  std::vector<double> B_i, B_o;  // [line_size][4]
  // G(theta_i) G(theta_o) / (cos cos) and, for z, its other side: H_i goes with B(theta_i).
  std::vector<std::vector<double>> K, H_i, H_o;              // [tables]
  std::array<std::vector<double>, kChannels> w, w_residual;  // 0 beyond the row
  std::vector<double> q;                                     // [max_lines]
};

JointRows::JointRows(const FoldedGrid& folded, const ModelSpec& spec)
    : folded_(folded),
      layout_(std::make_unique<Layout>(spec, folded.max_row_size())),
      cells_(folded, spec) {
  for (int share = 0; share < kShares; ++share) {
    shares_.push_back(std::make_unique<Share>(*layout_, folded.grid.theta_d));
  }
}

JointRows::~JointRows() = default;

// The row's products with the nodes of G.
void JointRows::AddCrossProducts(const FactorModel& model, Hessian hessian, const Pieces& G, int h,
                                 int d, Share* share) const {
  const Layout& layout = *layout_;
  const ModelSpec& spec = layout.spec;
  Share& of = *share;
  const int row = h * folded_.grid.theta_d + d;
  const int begin = folded_.row_begin[row], size = folded_.row_begin[row + 1] - begin;
  const int padded_size = (size + kBatch - 1) / kBatch * kBatch;
  const int16_t* const interval_i = &folded_.interval_i[begin];
  const int16_t* const interval_o = &folded_.interval_o[begin];
  const double *const t_i = &folded_.t_i[begin], *const t_o = &folded_.t_o[begin];

  SplineWeights(size, layout.columns, spec.g_nodes - 2, interval_i, t_i, of.B_i.data());
  SplineWeights(size, layout.columns, spec.g_nodes - 2, interval_o, t_o, of.B_o.data());
  for (size_t t = 0; t < G.size(); ++t) {
    for (int n = 0; n < size; ++n) {
      const double inverse_cosines = folded_.inverse_cosines[begin + n];
      const double G_i = G[t][interval_i[n]](t_i[n]), G_o = G[t][interval_o[n]](t_o[n]);
      of.K[t][n] = G_i * G_o * inverse_cosines;
      of.H_i[t][n] = G_o * inverse_cosines;
      of.H_o[t][n] = G_i * inverse_cosines;
    }
  }
  std::array<LobesOfRow, kChannels> lobes;
  for (int c = 0; c < kChannels; ++c) {
    double *const w = of.w[c].data(), *const w_residual = of.w_residual[c].data();
    const double* const rho = &folded_.rho[c][begin];
    for (int n = 0; n < size; ++n) w_residual[n] = model.d()[c] - rho[n];
    for (int m = 0; m < spec.lobes; ++m) {
      LobeOfRow& lobe = lobes[c][m];
      const double s = model.s(m)[c], D = model.D(m, c)[h], F = model.F(m, c)[d];
      lobe.x = s * D * F;
      lobe.DF = D * F;
      lobe.sF = s * F;
      lobe.sD = s * D;
      lobe.K = of.K[spec.table(Factor::kG, m, c)].data();
      for (int n = 0; n < size; ++n) w_residual[n] += lobe.x * lobe.K[n];
    }
    for (int n = 0; n < size; ++n) {
      w[n] = folded_.weight[c][begin + n];
      w_residual[n] *= w[n];
    }
    std::fill(w + size, w + padded_size, 0.0);
    std::fill(w_residual + size, w_residual + padded_size, 0.0);
  }

  for (int t = 0; t < static_cast<int>(G.size()); ++t) {
    const Layout::OfTable& table = layout.tables[t];
    const int num_near = table.num_near_lines(), num_far = static_cast<int>(table.far.size());
    double* const q = of.q.data();
    for (int line = 0; line < num_near + num_far; ++line) {
      std::fill_n(q + static_cast<size_t>(line) * layout.line_size, padded_size, 0.0);
    }
    const auto channels = spec.channels(Factor::kG, t);
    for (int c = channels.begin; c < channels.end; ++c) {
      double X = 0;
      for (int m = 0; m < spec.lobes; ++m) {
        LobeOfRow& lobe = lobes[c][m];
        lobe.served = spec.serves(Factor::kG, t, m, c);
        if (lobe.served) X += lobe.x;
        lobe.s_line = table.near_line[Layout::s(m, c)];
        lobe.D_line = table.near_line[layout.D(m, c)];
        lobe.F_line = num_near + table.far_line[layout.F(m, c)];
      }
      AddChannel(padded_size, X, of.w[c].data(), of.w_residual[c].data(), spec.lobes, lobes[c],
                 hessian == Hessian::kNewton, table.near_line[c], table.gradient_line(),
                 layout.line_size, q);
    }
    AddCrossSums(size, interval_i, interval_o, of.B_i.data(), of.B_o.data(), of.H_i[t].data(),
                 of.H_o[t].data(), layout.line_size, layout.padded_nodes,
                 {{{num_near, q, of.NearG(layout, table.near_begin)},
                   {num_far, q + static_cast<size_t>(num_near) * layout.line_size,
                    of.FarG(layout, d, table.far_begin)}}});
  }
}

// The row's products of d, s, D and F with each other, and their gradient.
void JointRows::AddRowParameters(const FactorModel& model, Hessian hessian, int h, int d,
                                 Share* share) const {
  const Layout& layout = *layout_;
  const int lobes = layout.spec.lobes, basis = cells_.basis();
  const int num_near = layout.num_near, num_far = layout.num_far;
  double* const near_H = share->near_H.data();
  double* const far_H = share->FarH(layout, d);
  double* const far_gradient = &share->far_gradient[static_cast<size_t>(d) * num_far];
  // d rho = sum of value phi_a d parameter over the terms, which are in order of the parameter.
  struct Term {
    int parameter = 0, a = 0;
    double value = 0;
  };
  std::array<Term, 1 + 2 * kMaxLobes> near;
  std::array<Term, kMaxLobes> far;
  for (int c = 0; c < kChannels; ++c) {
    near[0] = {c, 0, 1};
    for (int m = 0; m < lobes; ++m) {
      const double s = model.s(m)[c], D = model.D(m, c)[h], F = model.F(m, c)[d];
      near[1 + m] = {Layout::s(m, c), 1 + m, D * F};
      near[1 + lobes + m] = {layout.D(m, c), 1 + m, s * F};
      far[m] = {layout.F(m, c), 1 + m, s * D};
    }
    const double* const b = cells_.b(h, d, c);  // of the residual rho* - rho
    const double* const A = cells_.A(h, d, c);
    const auto product = [&](const Term& p, const Term& q) {
      return p.value * q.value * A[p.a * basis + q.a];
    };
    for (int i = 0; i < 1 + 2 * lobes; ++i) {
      const Term& p = near[i];
      share->near_gradient[p.parameter] -= p.value * b[p.a];
      double* const row = near_H + static_cast<size_t>(p.parameter) * num_near;
      row[p.parameter] += product(p, p);
      for (int j = i + 1; j < 1 + 2 * lobes; ++j) {
        const Term& q = near[j];
        row[q.parameter] += (q.parameter == p.parameter ? 2 : 1) * product(p, q);
      }
      for (int m = 0; m < lobes; ++m) {
        far_H[p.parameter * num_far + far[m].parameter] += product(p, far[m]);
      }
    }
    for (int m = 0; m < lobes; ++m) {
      const Term& p = far[m];
      far_gradient[p.parameter] -= p.value * b[p.a];
      double* const row = far_H + (num_near + p.parameter) * num_far;
      row[p.parameter] += product(p, p);
      for (int l = m + 1; l < lobes; ++l) {
        const Term& q = far[l];
        row[q.parameter] += (q.parameter == p.parameter ? 2 : 1) * product(p, q);
      }
    }
    if (hessian == Hessian::kGaussNewton) continue;
    for (int m = 0; m < lobes; ++m) {
      const double r_K = -b[1 + m];
      const int s = Layout::s(m, c), D = layout.D(m, c), F = layout.F(m, c);
      near_H[static_cast<size_t>(s) * num_near + D] += r_K * model.F(m, c)[d];
      far_H[s * num_far + F] += r_K * model.D(m, c)[h];
      far_H[D * num_far + F] += r_K * model.s(m)[c];
    }
  }
}

// Hands over what the rows of one theta_h added up for D, and clears that for the next.
void JointRows::MoveNear(const FactorModel& model, int h, Share* share,
                         QuadraticModel* result) const {
  const Layout& layout = *layout_;
  const ModelSpec& spec = layout.spec;
  const size_t n = result->gradient.size();
  const auto move = [](double* from, double* to) { *to = std::exchange(*from, 0.0); };
  for (int j = 0; j < spec.num_tables(Factor::kD); ++j) {
    const int near = layout.first_D + j;
    const size_t k = model.TableOffset(Factor::kD, j) + h;
    double* const row = &result->H[k * n];
    move(&share->near_gradient[near], &result->gradient[k]);
    for (int i = 0; i < layout.first_D; ++i) {
      move(&share->near_H[i * layout.num_near + near], &result->H[i * n + k]);
    }
    for (int i = j; i < spec.num_tables(Factor::kD); ++i) {
      move(&share->near_H[near * layout.num_near + layout.first_D + i],
           &row[model.TableOffset(Factor::kD, i) + h]);
    }
    result->squared_lengths[k] = row[k];
    for (int d = 0; d < spec.f_bins; ++d) {
      double* const far_H = share->FarH(layout, d) + near * layout.num_far;
      for (int f = 0; f < layout.num_far; ++f) {
        move(&far_H[f], &row[model.TableOffset(Factor::kF, f) + d]);
      }
    }
    for (size_t t = 0; t < layout.tables.size(); ++t) {
      const Layout::OfTable& table = layout.tables[t];
      if (table.near_line[near] < 0) continue;
      double* const sums = share->NearG(layout, table.near_begin + table.near_line[near]);
      std::copy_n(sums + 1, spec.g_nodes, &row[model.TableOffset(Factor::kG, static_cast<int>(t))]);
      std::fill_n(sums, layout.padded_nodes, 0.0);
    }
  }
}

// Adds what a share's rows of one theta_d added up for F.
void JointRows::AddFar(const FactorModel& model, int d, Share* share,
                       QuadraticModel* result) const {
  const Layout& layout = *layout_;
  const size_t n = result->gradient.size();
  const double* const far_H = share->FarH(layout, d);
  for (int f = 0; f < layout.num_far; ++f) {
    const size_t k = model.TableOffset(Factor::kF, f) + d;
    double* const row = &result->H[k * n];
    result->gradient[k] += share->far_gradient[static_cast<size_t>(d) * layout.num_far + f];
    for (int i = 0; i < layout.first_D; ++i) {
      result->H[i * n + k] += far_H[i * layout.num_far + f];
    }
    for (int i = f; i < layout.num_far; ++i) {
      row[model.TableOffset(Factor::kF, i) + d] +=
          far_H[(layout.num_near + f) * layout.num_far + i];
    }
    result->squared_lengths[k] = row[k];
    for (size_t t = 0; t < layout.tables.size(); ++t) {
      const Layout::OfTable& table = layout.tables[t];
      if (table.far_line[f] < 0) continue;
      Add(layout.spec.g_nodes, share->FarG(layout, d, table.far_begin + table.far_line[f]) + 1,
          &row[model.TableOffset(Factor::kG, static_cast<int>(t))]);
    }
  }
}

// Adds what all rows of a share added up for d and s, and the gradient of G.
void JointRows::AddNear(const FactorModel& model, Share* share, QuadraticModel* result) const {
  const Layout& layout = *layout_;
  const size_t n = result->gradient.size();
  for (int k = 0; k < layout.first_D; ++k) {
    double* const row = &result->H[k * n];
    result->gradient[k] += share->near_gradient[k];
    for (int i = k; i < layout.first_D; ++i) row[i] += share->near_H[k * layout.num_near + i];
    result->squared_lengths[k] = row[k];
  }
  for (size_t t = 0; t < layout.tables.size(); ++t) {
    const Layout::OfTable& table = layout.tables[t];
    const int offset = model.TableOffset(Factor::kG, static_cast<int>(t));
    for (int line = 0; line < table.num_near_lines(); ++line) {
      const bool of_gradient = line == table.gradient_line();
      if (!of_gradient && table.near[line] >= layout.first_D) continue;
      double* const to =
          of_gradient ? &result->gradient[offset] : &result->H[table.near[line] * n + offset];
      Add(layout.spec.g_nodes, share->NearG(layout, table.near_begin + line) + 1, to);
    }
  }
}

void JointRows::AddTo(const FactorModel& model, Hessian hessian, int num_threads,
                      QuadraticModel* result) {
  cells_.Accumulate(model, num_threads);
  const auto G = ShadowingPieces(model);
  ParallelFor(kShares, num_threads, [&](int s) {
    Share* const share = shares_[s].get();
    share->Clear();
    for (int h = s; h < folded_.grid.theta_h; h += kShares) {
      for (int d = 0; d < folded_.grid.theta_d; ++d) {
        const int row = h * folded_.grid.theta_d + d;
        if (folded_.row_begin[row] == folded_.row_begin[row + 1]) continue;
        AddRowParameters(model, hessian, h, d, share);
        AddCrossProducts(model, hessian, G, h, d, share);
      }
      MoveNear(model, h, share, result);
    }
  });
  ParallelFor(folded_.grid.theta_d, num_threads, [&](int d) {
    for (const auto& share : shares_) AddFar(model, d, share.get(), result);
  });
  for (const auto& share : shares_) AddNear(model, share.get(), result);
}

}  // namespace trilobe
