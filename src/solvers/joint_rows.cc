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

// The spline weights of four nodes as polynomials in Bernstein terms, term by term. Aligned, as the
// vectors alone are only where the machine has them.
struct alignas(sizeof(Lanes4)) WeightColumns {
  Lanes4 term[4] = {};
};

WeightColumns Columns(const CatmullRom& spline, int interval) {
  const auto weights = spline.WeightPolynomials(interval);
  WeightColumns columns;
  for (int k = 0; k < 4; ++k) {
    for (int a = 0; a < 4; ++a) columns.term[k][a] = weights[a][k];
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
    const Lanes4 weights = u * u * u * of.term[0] + u * u * t * of.term[1] +
                           u * t * t * of.term[2] + t * t * t * of.term[3];
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

// to[sample][line] = from[line][sample], in tiles of four by four.
TRILOBE_MULTIVERSION
void Transpose(int lines, int size, int line_size, const double* __restrict from,
               double* __restrict to) {
  for (int line = 0; line < lines; line += 4) {
    for (int n = 0; n < size; n += 4) {
      const double* const tile = from + static_cast<size_t>(line) * line_size + n;
      Lanes4 a, b, c, d;
      std::memcpy(&a, tile, sizeof(a));
      std::memcpy(&b, tile + line_size, sizeof(b));
      std::memcpy(&c, tile + 2 * line_size, sizeof(c));
      std::memcpy(&d, tile + 3 * line_size, sizeof(d));
      const Lanes4 ab_02 = __builtin_shufflevector(a, b, 0, 4, 2, 6);
      const Lanes4 ab_13 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
      const Lanes4 cd_02 = __builtin_shufflevector(c, d, 0, 4, 2, 6);
      const Lanes4 cd_13 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
      const Lanes4 columns[] = {__builtin_shufflevector(ab_02, cd_02, 0, 1, 4, 5),
                                __builtin_shufflevector(ab_13, cd_13, 0, 1, 4, 5),
                                __builtin_shufflevector(ab_02, cd_02, 2, 3, 6, 7),
                                __builtin_shufflevector(ab_13, cd_13, 2, 3, 6, 7)};
      for (int k = 0; k < 4; ++k) {
        std::memcpy(to + static_cast<size_t>(n + k) * lines + line, &columns[k], sizeof(Lanes4));
      }
    }
  }
}

// sum += z q
template <typename Lanes>
[[gnu::always_inline]] inline void AddProduct(double z, const double* q, double* sum) {
  Lanes q_lanes, sums;
  std::memcpy(&q_lanes, q, sizeof(Lanes));
  std::memcpy(&sums, sum, sizeof(Lanes));
  sums += z * q_lanes;
  std::memcpy(sum, &sums, sizeof(Lanes));
}

// near, far [node][line] += z q for the four nodes of both sides of each sample, where z = B H.
// q: [size][near lines, then far lines]
TRILOBE_MULTIVERSION
void AddCrossSums(int size, const int16_t* interval_i, const int16_t* interval_o, const double* B_i,
                  const double* B_o, const double* H_i, const double* H_o, int near_lines,
                  int far_lines, const double* q, double* near, double* far) {
  for (int n = 0; n < size; ++n, q += near_lines + far_lines) {
    for (const bool i : {true, false}) {
      const int interval = i ? interval_i[n] : interval_o[n];
      const double* const B = (i ? B_i : B_o) + 4 * n;
      const double H = i ? H_i[n] : H_o[n];
      double* near_node = near + static_cast<size_t>(interval) * near_lines;
      double* far_node = far + static_cast<size_t>(interval) * far_lines;
      for (int a = 0; a < 4; ++a, near_node += near_lines, far_node += far_lines) {
        const double z = B[a] * H;
        for (int line = 0; line < near_lines; line += 8) {
          AddProduct<Lanes8>(z, q + line, near_node + line);
        }
        for (int line = 0; line < far_lines; line += 4) {
          AddProduct<Lanes4>(z, q + near_lines + line, far_node + line);
        }
      }
    }
  }
}

TRILOBE_MULTIVERSION
void Add(int size, const double* __restrict x, double* __restrict y) {
  for (int k = 0; k < size; ++k) y[k] += x[k];
}

// Doubles from the start of a cache line, which no vector of them straddles then.
class AlignedSums {
 public:
  explicit AlignedSums(size_t size) : lines_((size + 7) / 8) {}
  void Clear() { std::ranges::fill(lines_, CacheLine()); }
  double* data() { return lines_.empty() ? nullptr : lines_[0].values; }
  size_t size() const { return 8 * lines_.size(); }

 private:
  struct alignas(64) CacheLine {
    double values[8] = {};
  };
  std::vector<CacheLine> lines_;
};

}  // namespace

// What lies where in the sums of a share. A row has "near" parameters, those of all rows of its
// theta_h, numbered d, s as in a model, then one of each table of D; and "far" ones, of all rows of
// its theta_d: one of each table of F. Those that serve some channel in common with a table of G
// have a line in its sums; one more near line has the gradient of G.
class JointRows::Layout {
 public:
  struct OfTable {
    std::vector<int> near_line, far_line;  // of each parameter; none: -1
    int gradient_line = 0;
    int near_lines = 0, far_lines = 0;     // padded to whole vectors
    size_t near_begin = 0, far_begin = 0;  // where the sums start
    int lines() const { return near_lines + far_lines; }
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
      const auto number = [](std::vector<int>* line_of) {
        int lines = 0;
        for (int& line : *line_of) {
          if (line == 0) line = lines++;
        }
        return lines;
      };
      const auto padded = [](int size, int to) { return (size + to - 1) / to * to; };
      table.gradient_line = number(&table.near_line);
      table.near_lines = padded(table.gradient_line + 1, 8);
      table.far_lines = padded(number(&table.far_line), 4);
      table.near_begin = near_size;
      table.far_begin = far_size;
      near_size += static_cast<size_t>(table.near_lines) * padded_nodes;
      far_size += static_cast<size_t>(table.far_lines) * padded_nodes;
      max_lines = std::max(max_lines, table.lines());
    }
  }

  // Numbers of parameters; F's is far.
  static int s(int m, int c) { return kChannels * (1 + m) + c; }
  int D(int m, int c) const { return first_D + spec.table(Factor::kD, m, c); }
  int F(int m, int c) const { return spec.table(Factor::kF, m, c); }

  const ModelSpec spec;
  const int first_D, num_near, num_far, padded_nodes, line_size;
  int max_lines = 0;
  size_t near_size = 0, far_size = 0;  // of the sums of all tables
  std::vector<OfTable> tables;
  std::array<WeightColumns, 3> columns;
};

struct JointRows::Share {
  explicit Share(const Layout& layout, int theta_d)
      : near_H(static_cast<size_t>(layout.num_near) * layout.num_near),
        near_gradient(layout.num_near),
        near_G(layout.near_size),
        far_H(static_cast<size_t>(theta_d) * (layout.num_near + layout.num_far) * layout.num_far),
        far_gradient(static_cast<size_t>(theta_d) * layout.num_far),
        far_G(theta_d * layout.far_size),
        B_i(4 * static_cast<size_t>(layout.line_size)),
        B_o(B_i.size()),
        q(static_cast<size_t>(layout.max_lines) * layout.line_size),
        q_by_sample(q.size()) {
    for (auto* of_channels : {&w, &w_residual}) {
      of_channels->fill(std::vector<double>(layout.line_size));
    }
    for (auto* of_tables : {&K, &H_i, &H_o}) {
      of_tables->assign(layout.tables.size(), std::vector<double>(layout.line_size));
    }
  }

  void Clear() {
    for (auto* sums : {&near_H, &near_gradient, &far_H, &far_gradient}) {
      std::ranges::fill(*sums, 0.0);
    }
    near_G.Clear();
    far_G.Clear();
  }

  double* FarH(const Layout& layout, int d) {
    return far_H.data() +
           static_cast<size_t>(d) * (layout.num_near + layout.num_far) * layout.num_far;
  }

  double* FarGradient(const Layout& layout, int d) {
    return far_gradient.data() + static_cast<size_t>(d) * layout.num_far;
  }
  double* FarG(const Layout& layout, int d) { return far_G.data() + d * layout.far_size; }

  std::vector<double> near_H;         // [near][near], from the diagonal
  std::vector<double> near_gradient;  // [near]
  AlignedSums near_G;                 // by table: [padded_nodes][near lines]
  std::vector<double> far_H;          // [theta_d][near, then far][far], from the diagonal
  std::vector<double> far_gradient;   // [theta_d][far]
  AlignedSums far_G;                  // [theta_d], by table: [padded_nodes][far lines]

  // Of one row. [..][line_size]
  std::vector<double> B_i, B_o;  // [line_size][4]
  // G(theta_i) G(theta_o) / (cos cos) and, for z, its other side: H_i goes with B(theta_i).
  std::vector<std::vector<double>> K, H_i, H_o;              // [tables]
  std::array<std::vector<double>, kChannels> w, w_residual;  // 0 beyond the row
  std::vector<double> q;                                     // [lines]
  AlignedSums q_by_sample;                                   // [line_size][lines]
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
    double* const q = of.q.data();
    for (int line = 0; line < table.lines(); ++line) {
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
        lobe.F_line = table.near_lines + table.far_line[layout.F(m, c)];
      }
      AddChannel(padded_size, X, of.w[c].data(), of.w_residual[c].data(), spec.lobes, lobes[c],
                 hessian == Hessian::kNewton, table.near_line[c], table.gradient_line,
                 layout.line_size, q);
    }
    Transpose(table.lines(), padded_size, layout.line_size, q, of.q_by_sample.data());
    AddCrossSums(size, interval_i, interval_o, of.B_i.data(), of.B_o.data(), of.H_i[t].data(),
                 of.H_o[t].data(), table.near_lines, table.far_lines, of.q_by_sample.data(),
                 of.near_G.data() + table.near_begin, of.FarG(layout, d) + table.far_begin);
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
  double* const far_gradient = share->FarGradient(layout, d);
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
      double* sum = share->near_G.data() + table.near_begin + table.near_line[near];
      double* const to = &row[model.TableOffset(Factor::kG, static_cast<int>(t))];
      for (int node = -1; node <= spec.g_nodes; ++node, sum += table.near_lines) {
        const double value = std::exchange(*sum, 0.0);
        if (node >= 0 && node < spec.g_nodes) to[node] = value;
      }
    }
  }
}

// Hands over what the rows of one theta_d added up for F.
void JointRows::SetFar(const FactorModel& model, int d, QuadraticModel* result) const {
  const Layout& layout = *layout_;
  Share& sum = *shares_[0];
  const int size_H = (layout.num_near + layout.num_far) * layout.num_far;
  for (int s = 1; s < kShares; ++s) {
    Share& share = *shares_[s];
    Add(size_H, share.FarH(layout, d), sum.FarH(layout, d));
    Add(layout.num_far, share.FarGradient(layout, d), sum.FarGradient(layout, d));
    Add(static_cast<int>(layout.far_size), share.FarG(layout, d), sum.FarG(layout, d));
  }
  const size_t n = result->gradient.size();
  const double* const far_H = sum.FarH(layout, d);
  for (int f = 0; f < layout.num_far; ++f) {
    const size_t k = model.TableOffset(Factor::kF, f) + d;
    double* const row = &result->H[k * n];
    result->gradient[k] = sum.FarGradient(layout, d)[f];
    for (int i = 0; i < layout.first_D; ++i) result->H[i * n + k] = far_H[i * layout.num_far + f];
    for (int i = f; i < layout.num_far; ++i) {
      row[model.TableOffset(Factor::kF, i) + d] = far_H[(layout.num_near + f) * layout.num_far + i];
    }
    result->squared_lengths[k] = row[k];
    for (size_t t = 0; t < layout.tables.size(); ++t) {
      const Layout::OfTable& table = layout.tables[t];
      if (table.far_line[f] < 0) continue;
      const double* const sums = sum.FarG(layout, d) + table.far_begin + table.far_line[f];
      double* const to = &row[model.TableOffset(Factor::kG, static_cast<int>(t))];
      for (int node = 0; node < layout.spec.g_nodes; ++node) {
        to[node] = sums[(1 + node) * table.far_lines];
      }
    }
  }
}

// Hands over what all rows added up for d and s, and the gradient of G.
void JointRows::SetNear(const FactorModel& model, QuadraticModel* result) const {
  const Layout& layout = *layout_;
  Share& sum = *shares_[0];
  for (int s = 1; s < kShares; ++s) {
    Share& share = *shares_[s];
    Add(layout.num_near * layout.num_near, share.near_H.data(), sum.near_H.data());
    Add(layout.num_near, share.near_gradient.data(), sum.near_gradient.data());
    Add(static_cast<int>(layout.near_size), share.near_G.data(), sum.near_G.data());
  }
  const size_t n = result->gradient.size();
  for (int k = 0; k < layout.first_D; ++k) {
    double* const row = &result->H[k * n];
    result->gradient[k] = sum.near_gradient[k];
    for (int i = k; i < layout.first_D; ++i) row[i] = sum.near_H[k * layout.num_near + i];
    result->squared_lengths[k] = row[k];
  }
  for (size_t t = 0; t < layout.tables.size(); ++t) {
    const Layout::OfTable& table = layout.tables[t];
    const int offset = model.TableOffset(Factor::kG, static_cast<int>(t));
    const double* const sums = sum.near_G.data() + table.near_begin;
    for (int node = 0; node < layout.spec.g_nodes; ++node) {
      const double* const of_node = sums + (1 + node) * table.near_lines;
      result->gradient[offset + node] = of_node[table.gradient_line];
      for (int k = 0; k < layout.first_D; ++k) {
        if (table.near_line[k] < 0) continue;
        result->H[k * n + offset + node] = of_node[table.near_line[k]];
      }
    }
  }
}

void JointRows::Evaluate(const FactorModel& model, Hessian hessian, int num_threads,
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
  ParallelFor(folded_.grid.theta_d, num_threads, [&](int d) { SetFar(model, d, result); });
  SetNear(model, result);
}

}  // namespace trilobe
