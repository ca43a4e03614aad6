#include "trilobe/sums/grid/joint_rows.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "trilobe/base/parallel.h"
#include "trilobe/math/add_to.h"
#include "trilobe/math/catmull_rom.h"
#include "trilobe/model/shadowing_pieces.h"
#include "trilobe/sums/grid/row_kernels.h"

namespace trilobe {
namespace {

constexpr int kMaxPaddedBasis = (1 + kMaxLobes + 3) / 4 * 4;

using Pieces = std::vector<std::vector<CatmullRom::Piece>>;

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

// d rho = sum of value phi_a d parameter over the terms of all parameters.
struct Term {
  int parameter = 0, a = 0;
  double value = 0;
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
        padded_nodes(spec.g_axis.size + 2),
        line_size((max_row + kBatch - 1) / kBatch * kBatch),
        basis((1 + spec.lobes + 3) / 4 * 4),
        sums_size((basis + 1) * basis),
        tables(spec.num_tables(Factor::kG)) {
    const CatmullRom spline(spec.g_axis.size);
    columns = {WeightsOfNodes(spline, 0), WeightsOfNodes(spline, 1),
               WeightsOfNodes(spline, spec.g_axis.size - 2)};
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
  const int basis, sums_size;  // of AddRowSums
  int max_lines = 0;
  size_t near_size = 0, far_size = 0;  // of the sums of all tables
  std::vector<OfTable> tables;
  std::array<OfNodes<4>, 3> columns;
};

struct JointRows::Share {
  Share(const Layout& layout, int theta_d)
      : near_H(static_cast<size_t>(layout.num_near) * layout.num_near),
        near_gradient(layout.num_near),
        near_sums(static_cast<size_t>(kChannels) * layout.sums_size),
        D_F(static_cast<size_t>(theta_d) * layout.num_near * layout.num_far),
        far_sums(theta_d * near_sums.size()),
        near_G(layout.near_size),
        far_G(theta_d * layout.far_size),
        B_i(4 * static_cast<size_t>(layout.line_size)),
        B_o(B_i.size()),
        phi_lines(static_cast<size_t>(layout.basis) * layout.line_size),
        phi(phi_lines.size()),
        q_lines(static_cast<size_t>(layout.max_lines) * layout.line_size),
        q(q_lines.size()) {
    std::fill_n(phi_lines.begin(), layout.line_size, 1.0);
    w_residual.fill(std::vector<double>(layout.line_size));
    w = w_residual;
    for (auto* of_tables : {&K, &H_i, &H_o}) {
      of_tables->assign(layout.tables.size(), std::vector<double>(layout.line_size));
    }
  }

  void Clear() {
    objective = 0;
    for (auto* sums : {&near_H, &near_gradient, &near_sums, &D_F, &far_sums}) {
      std::ranges::fill(*sums, 0.0);
    }
    near_G.Clear();
    far_G.Clear();
  }

  double* FarSums(const Layout& layout, int d) {
    return far_sums.data() + static_cast<size_t>(d) * kChannels * layout.sums_size;
  }
  double* FarG(const Layout& layout, int d) { return far_G.data() + d * layout.far_size; }

  double objective = 0;
  // Of all rows for d and s, of those of the present theta_h for D.
  std::vector<double> near_H;         // [near][near], from the diagonal
  std::vector<double> near_gradient;  // [near]
  // AddRowSums of the rows of the present theta_h, with f the factors F; of those of each theta_d,
  // with g the factors D.
  std::vector<double> near_sums;  // [kChannels][sums_size]
  std::vector<double> D_F;        // H of the present theta_h. [theta_d][near][far]
  std::vector<double> far_sums;   // [theta_d][kChannels][sums_size]
  AlignedSums near_G;             // by table: [padded_nodes][near lines]
  AlignedSums far_G;              // [theta_d], by table: [padded_nodes][far lines]

  // Of one row, padded to whole batches.
  int size = 0, padded_size = 0;
  const int16_t *interval_i = nullptr, *interval_o = nullptr;
  std::array<LobesOfRow, kChannels> lobes;
  std::vector<double> B_i, B_o;                              // [line_size][4]
  std::vector<std::vector<double>> K, H_i, H_o;              // [tables][line_size]
  std::array<std::vector<double>, kChannels> w, w_residual;  // 0 beyond the row
  std::vector<double> phi_lines;                             // [basis][line_size]
  AlignedSums phi;                                           // [line_size][basis]
  std::vector<double> q_lines;                               // [lines][line_size]
  AlignedSums q;                                             // [line_size][lines]
};

JointRows::JointRows(const FoldedGrid& folded, const ModelSpec& spec)
    : folded_(folded), layout_(std::make_unique<Layout>(spec, folded.max_row_size())) {
  for (int share = 0; share < NumShares(folded.size()); ++share) {
    shares_.push_back(std::make_unique<Share>(*layout_, folded.grid.theta_d));
  }
}

JointRows::~JointRows() = default;

// What the sums of a row need.
void JointRows::ReadRow(const FactorModel& model, const Pieces& G, int h, int d,
                        Share* share) const {
  const Layout& layout = *layout_;
  const ModelSpec& spec = layout.spec;
  Share& of = *share;
  const int row = h * folded_.grid.theta_d + d;
  const int begin = folded_.row_begin[row], size = folded_.row_begin[row + 1] - begin;
  const int padded_size = (size + kBatch - 1) / kBatch * kBatch;
  of.size = size;
  of.padded_size = padded_size;
  of.interval_i = &folded_.interval_i[begin];
  of.interval_o = &folded_.interval_o[begin];
  const double *const t_i = &folded_.t_i[begin], *const t_o = &folded_.t_o[begin];

  SplineWeights(size, layout.columns, spec.g_axis.size - 2, of.interval_i, t_i, of.B_i.data());
  SplineWeights(size, layout.columns, spec.g_axis.size - 2, of.interval_o, t_o, of.B_o.data());
  for (size_t t = 0; t < G.size(); ++t) {
    ReadTable(size, G[t].data(), of.interval_i, of.interval_o, t_i, t_o,
              &folded_.inverse_cosines[begin], of.K[t].data(), of.H_i[t].data(), of.H_o[t].data());
  }
  for (int c = 0; c < kChannels; ++c) {
    for (int m = 0; m < spec.lobes; ++m) {
      LobeOfRow& lobe = of.lobes[c][m];
      const double s = model.s(m)[c], D = model.D(m, c)[h], F = model.F(m, c)[d];
      lobe.x = s * D * F;
      lobe.DF = D * F;
      lobe.sF = s * F;
      lobe.sD = s * D;
      lobe.K = of.K[spec.table(Factor::kG, m, c)].data();
    }
    double *const w = of.w[c].data(), *const w_residual = of.w_residual[c].data();
    std::copy_n(&folded_.weight[c][begin], size, w);
    of.objective += WeighResiduals(size, model.d()[c], spec.lobes, of.lobes[c], w,
                                   &folded_.rho[c][begin], w_residual);
    std::fill(w + size, w + padded_size, 0.0);
    std::fill(w_residual + size, w_residual + padded_size, 0.0);
  }
}

// The row's products with the nodes of G.
void JointRows::AddCrossProducts(Hessian hessian, int d, Share* share) const {
  const Layout& layout = *layout_;
  const ModelSpec& spec = layout.spec;
  Share& of = *share;
  for (int t = 0; t < static_cast<int>(layout.tables.size()); ++t) {
    const Layout::OfTable& table = layout.tables[t];
    double* const q = of.q_lines.data();
    for (int line = 0; line < table.lines(); ++line) {
      std::fill_n(q + static_cast<size_t>(line) * layout.line_size, of.padded_size, 0.0);
    }
    const auto channels = spec.channels(Factor::kG, t);
    for (int c = channels.begin; c < channels.end; ++c) {
      double X = 0;
      for (int m = 0; m < spec.lobes; ++m) {
        LobeOfRow& lobe = of.lobes[c][m];
        lobe.served = spec.serves(Factor::kG, t, m, c);
        if (lobe.served) X += lobe.x;
        lobe.s_line = table.near_line[Layout::s(m, c)];
        lobe.D_line = table.near_line[layout.D(m, c)];
        lobe.F_line = table.near_lines + table.far_line[layout.F(m, c)];
      }
      AddChannel(of.padded_size, X, of.w[c].data(), of.w_residual[c].data(), spec.lobes,
                 of.lobes[c], hessian == Hessian::kNewton, table.near_line[c], table.gradient_line,
                 layout.line_size, q);
    }
    Transpose(table.lines(), of.padded_size, layout.line_size, q, of.q.data());
    AddCrossSums({of.size, of.interval_i, of.interval_o, of.B_i.data(), of.B_o.data(),
                  of.H_i[t].data(), of.H_o[t].data()},
                 table.near_lines, table.far_lines, of.q.data(),
                 of.near_G.data() + table.near_begin, of.FarG(layout, d) + table.far_begin);
  }
}

// The row's products of d, s, D and F with each other.
void JointRows::AddProducts(const FactorModel& model, Hessian hessian, int h, int d,
                            Share* share) const {
  const Layout& layout = *layout_;
  const int basis = layout.basis;
  std::array<double, kMaxPaddedBasis> f{1}, g{1};
  std::array<double, (kMaxPaddedBasis + 1) * kMaxPaddedBasis> sums;
  double* const D_F = share->D_F.data() + static_cast<size_t>(d) * layout.num_near * layout.num_far;
  for (int c = 0; c < kChannels; ++c) {
    const LobesOfRow& lobes = share->lobes[c];
    for (int m = 0; m < layout.spec.lobes; ++m) {
      f[1 + m] = model.F(m, c)[d];
      g[1 + m] = model.D(m, c)[h];
    }
    if (c == 0 || layout.spec.G.per_channel) {
      for (int m = 0; m < layout.spec.lobes; ++m) {
        std::copy_n(lobes[m].K, share->padded_size,
                    &share->phi_lines[static_cast<size_t>(1 + m) * layout.line_size]);
      }
      Transpose(basis, share->padded_size, layout.line_size, share->phi_lines.data(),
                share->phi.data());
    }
    AddRowSums(share->size, basis, share->w[c].data(), share->w_residual[c].data(),
               share->phi.data(), f.data(), g.data(), sums.data(),
               &share->near_sums[c * layout.sums_size],
               share->FarSums(layout, d) + c * layout.sums_size);
    for (int m = 0; m < layout.spec.lobes; ++m) {
      double* const of_D = D_F + layout.D(m, c) * layout.num_far;
      const double* const A = &sums[(1 + m) * basis + 1];
      for (int l = 0; l < layout.spec.lobes; ++l) {
        of_D[layout.F(l, c)] += lobes[m].sF * lobes[l].sD * A[l];
      }
      if (hessian == Hessian::kGaussNewton) continue;
      of_D[layout.F(m, c)] += model.s(m)[c] * sums[basis * basis + 1 + m];
    }
  }
}

// The part in which F takes no part of what the rows of one theta_h added up. Clears it.
void JointRows::SpreadNear(const FactorModel& model, Hessian hessian, int h, Share* share) const {
  const Layout& layout = *layout_;
  const int lobes = layout.spec.lobes;
  std::array<Term, 1 + 2 * kMaxLobes> terms;
  for (int c = 0; c < kChannels; ++c) {
    terms[0] = {c, 0, 1};
    for (int m = 0; m < lobes; ++m) {
      terms[1 + m] = {Layout::s(m, c), 1 + m, model.D(m, c)[h]};
      terms[1 + lobes + m] = {layout.D(m, c), 1 + m, model.s(m)[c]};
    }
    const double* const A = &share->near_sums[c * layout.sums_size];
    const double* const b = A + layout.basis * layout.basis;
    for (int i = 0; i < 1 + 2 * lobes; ++i) {
      const Term& p = terms[i];
      share->near_gradient[p.parameter] += p.value * b[p.a];
      for (int j = i; j < 1 + 2 * lobes; ++j) {
        const Term& q = terms[j];
        const double product = p.value * q.value * A[p.a * layout.basis + q.a];
        share->near_H[static_cast<size_t>(p.parameter) * layout.num_near + q.parameter] +=
            i != j && p.parameter == q.parameter ? 2 * product : product;
      }
    }
    for (int m = 0; m < lobes && hessian == Hessian::kNewton; ++m) {
      share->near_H[static_cast<size_t>(Layout::s(m, c)) * layout.num_near + layout.D(m, c)] +=
          b[1 + m];
    }
  }
  std::ranges::fill(share->near_sums, 0.0);
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
    for (int d = 0; d < spec.f_axis.size; ++d) {
      double* const D_F =
          &share->D_F[(static_cast<size_t>(d) * layout.num_near + near) * layout.num_far];
      for (int f = 0; f < layout.num_far; ++f) {
        move(&D_F[f], &row[model.TableOffset(Factor::kF, f) + d]);
      }
    }
    for (size_t t = 0; t < layout.tables.size(); ++t) {
      const Layout::OfTable& table = layout.tables[t];
      if (table.near_line[near] < 0) continue;
      double* sum = share->near_G.data() + table.near_begin + table.near_line[near];
      double* const to = &row[model.TableOffset(Factor::kG, static_cast<int>(t))];
      for (int node = -1; node <= spec.g_axis.size; ++node, sum += table.near_lines) {
        const double value = std::exchange(*sum, 0.0);
        if (node >= 0 && node < spec.g_axis.size) to[node] = value;
      }
    }
  }
}

// Hands over what the rows of one theta_d added up for F.
void JointRows::SetFar(const FactorModel& model, Hessian hessian, int d,
                       QuadraticModel* result) const {
  const Layout& layout = *layout_;
  const int lobes = layout.spec.lobes;
  Share& sum = *shares_[0];
  for (size_t s = 1; s < shares_.size(); ++s) {
    Share& share = *shares_[s];
    AddTo(static_cast<size_t>(kChannels) * layout.sums_size, share.FarSums(layout, d),
          sum.FarSums(layout, d));
    AddTo(layout.far_size, share.FarG(layout, d), sum.FarG(layout, d));
  }
  const size_t n = result->gradient.size();
  for (int c = 0; c < kChannels; ++c) {
    const double* const A = sum.FarSums(layout, d) + c * layout.sums_size;
    const double* const b = A + layout.basis * layout.basis;
    for (int m = 0; m < lobes; ++m) {
      const size_t k = model.TableOffset(Factor::kF, layout.F(m, c)) + d;
      const double s_m = model.s(m)[c];
      const double* const A_m = A + (1 + m) * layout.basis;
      result->gradient[k] += s_m * b[1 + m];
      result->H[c * n + k] += s_m * A_m[0];
      for (int l = 0; l < lobes; ++l) {
        const size_t k_l = model.TableOffset(Factor::kF, layout.F(l, c)) + d;
        result->H[Layout::s(l, c) * n + k] += s_m * model.F(l, c)[d] * A_m[1 + l];
        if (k <= k_l) result->H[k * n + k_l] += s_m * model.s(l)[c] * A_m[1 + l];
      }
      if (hessian == Hessian::kNewton) result->H[Layout::s(m, c) * n + k] += b[1 + m];
    }
  }
  for (int f = 0; f < layout.num_far; ++f) {
    const size_t k = model.TableOffset(Factor::kF, f) + d;
    double* const row = &result->H[k * n];
    result->squared_lengths[k] = row[k];
    for (size_t t = 0; t < layout.tables.size(); ++t) {
      const Layout::OfTable& table = layout.tables[t];
      if (table.far_line[f] < 0) continue;
      const double* const sums = sum.FarG(layout, d) + table.far_begin + table.far_line[f];
      double* const to = &row[model.TableOffset(Factor::kG, static_cast<int>(t))];
      for (int node = 0; node < layout.spec.g_axis.size; ++node) {
        to[node] = sums[(1 + node) * table.far_lines];
      }
    }
  }
}

// Hands over what all rows added up for d and s, and the gradient of G.
void JointRows::SetNear(const FactorModel& model, QuadraticModel* result) const {
  const Layout& layout = *layout_;
  Share& sum = *shares_[0];
  for (size_t s = 1; s < shares_.size(); ++s) {
    Share& share = *shares_[s];
    sum.objective += share.objective;
    AddTo(sum.near_H.size(), share.near_H.data(), sum.near_H.data());
    AddTo(sum.near_gradient.size(), share.near_gradient.data(), sum.near_gradient.data());
    AddTo(layout.near_size, share.near_G.data(), sum.near_G.data());
  }
  result->objective = folded_.constant + sum.objective;
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
    for (int node = 0; node < layout.spec.g_axis.size; ++node) {
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
  const auto G = ShadowingPieces(model);
  const int num_shares = static_cast<int>(shares_.size());
  ParallelFor(num_shares, num_threads, [&](int s) {
    Share* const share = shares_[s].get();
    share->Clear();
    for (int h = s; h < folded_.grid.theta_h; h += num_shares) {
      for (int d = 0; d < folded_.grid.theta_d; ++d) {
        const int row = h * folded_.grid.theta_d + d;
        if (folded_.row_begin[row] == folded_.row_begin[row + 1]) continue;
        ReadRow(model, G, h, d, share);
        AddProducts(model, hessian, h, d, share);
        AddCrossProducts(hessian, d, share);
      }
      SpreadNear(model, hessian, h, share);
      MoveNear(model, h, share, result);
    }
  });
  ParallelFor(folded_.grid.theta_d, num_threads, [&](int d) { SetFar(model, hessian, d, result); });
  SetNear(model, result);
}

}  // namespace trilobe
