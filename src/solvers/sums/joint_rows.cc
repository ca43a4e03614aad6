#include "solvers/sums/joint_rows.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "model/objective/shadowing_pieces.h"
#include "solvers/sums/kernels.h"
#include "solvers/sums/row_accumulator.h"
#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

constexpr int kMaxPaddedBasis = (1 + kMaxLobes + 3) / 4 * 4;

using Pieces = std::vector<std::vector<CatmullRom::Piece>>;

// d rho = sum of value phi_a d parameter over the terms of all parameters.
struct Term {
  int parameter = 0, a = 0;
  double value = 0;
};

}  // namespace

JointRows::JointRows(const FoldedGrid& folded, const ModelSpec& spec)
    : folded_(folded), layout_(std::make_unique<RowLayout>(spec, folded.max_row_size())) {
  for (int k = 0; k < NumAccumulators(folded.size()); ++k) {
    accumulators_.push_back(std::make_unique<RowAccumulator>(*layout_, folded.grid.theta_d));
  }
}

JointRows::~JointRows() = default;

// Reads the inputs of the sums of a row.
void JointRows::ReadRow(const FactorModel& model, const Pieces& G, int h, int d,
                        RowAccumulator* accumulator) const {
  const RowLayout& layout = *layout_;
  const ModelSpec& spec = layout.spec;
  RowAccumulator& sums = *accumulator;
  const int row = h * folded_.grid.theta_d + d;
  const int begin = folded_.row_begin[row], size = folded_.row_begin[row + 1] - begin;
  const int padded_size = (size + kBatch - 1) / kBatch * kBatch;
  sums.size = size;
  sums.padded_size = padded_size;
  sums.interval_i = &folded_.interval_i[begin];
  sums.interval_o = &folded_.interval_o[begin];
  const double *const t_i = &folded_.t_i[begin], *const t_o = &folded_.t_o[begin];

  SplineWeights(size, layout.columns, spec.g_axis.size - 2, sums.interval_i, t_i, sums.B_i.data());
  SplineWeights(size, layout.columns, spec.g_axis.size - 2, sums.interval_o, t_o, sums.B_o.data());
  for (size_t t = 0; t < G.size(); ++t) {
    ReadTable(size, G[t].data(), sums.interval_i, sums.interval_o, t_i, t_o,
              &folded_.inverse_cosines[begin], sums.K[t].data(), sums.H_i[t].data(),
              sums.H_o[t].data());
  }
  for (int c = 0; c < kChannels; ++c) {
    for (int m = 0; m < spec.lobes; ++m) {
      LobeOfRow& lobe = sums.lobes[c][m];
      const double s = model.s(m)[c], D = model.D(m, c)[h], F = model.F(m, c)[d];
      lobe.x = s * D * F;
      lobe.DF = D * F;
      lobe.sF = s * F;
      lobe.sD = s * D;
      lobe.K = sums.K[spec.table(Factor::kG, m, c)].data();
    }
    double *const w = sums.w[c].data(), *const w_residual = sums.w_residual[c].data();
    std::copy_n(&folded_.weight[c][begin], size, w);
    sums.objective += WeighResiduals(size, model.d()[c], spec.lobes, sums.lobes[c], w,
                                     &folded_.rho[c][begin], w_residual);
    std::fill(w + size, w + padded_size, 0.0);
    std::fill(w_residual + size, w_residual + padded_size, 0.0);
  }
}

// The row's products with the nodes of G.
void JointRows::AddCrossProducts(Hessian hessian, int d, RowAccumulator* accumulator) const {
  const RowLayout& layout = *layout_;
  const ModelSpec& spec = layout.spec;
  RowAccumulator& sums = *accumulator;
  for (int t = 0; t < static_cast<int>(layout.tables.size()); ++t) {
    const RowLayout::OfTable& table = layout.tables[t];
    double* const q = sums.q_lines.data();
    for (int line = 0; line < table.lines(); ++line) {
      std::fill_n(q + static_cast<size_t>(line) * layout.line_size, sums.padded_size, 0.0);
    }
    const auto channels = spec.channels(Factor::kG, t);
    for (int c = channels.begin; c < channels.end; ++c) {
      double X = 0;
      for (int m = 0; m < spec.lobes; ++m) {
        LobeOfRow& lobe = sums.lobes[c][m];
        lobe.served = spec.serves(Factor::kG, t, m, c);
        if (lobe.served) X += lobe.x;
        lobe.s_line = table.theta_h_line[RowLayout::s(m, c)];
        lobe.D_line = table.theta_h_line[layout.D(m, c)];
        lobe.F_line = table.theta_h_lines + table.theta_d_line[layout.F(m, c)];
      }
      AddChannel(sums.padded_size, X, sums.w[c].data(), sums.w_residual[c].data(), spec.lobes,
                 sums.lobes[c], hessian == Hessian::kNewton, table.theta_h_line[c],
                 table.gradient_line, layout.line_size, q);
    }
    Transpose(table.lines(), sums.padded_size, layout.line_size, q, sums.q.data());
    AddCrossSums({sums.size, sums.interval_i, sums.interval_o, sums.B_i.data(), sums.B_o.data(),
                  sums.H_i[t].data(), sums.H_o[t].data()},
                 table.theta_h_lines, table.theta_d_lines, sums.q.data(),
                 sums.theta_h_G.data() + table.theta_h_begin,
                 sums.ThetaDG(layout, d) + table.theta_d_begin);
  }
}

// The row's products of d, s, D and F with each other.
void JointRows::AddProducts(const FactorModel& model, Hessian hessian, int h, int d,
                            RowAccumulator* accumulator) const {
  const RowLayout& layout = *layout_;
  const int basis = layout.basis;
  std::array<double, kMaxPaddedBasis> f{1}, g{1};
  std::array<double, (kMaxPaddedBasis + 1) * kMaxPaddedBasis> sums;
  double* const D_F = accumulator->D_F.data() +
                      static_cast<size_t>(d) * layout.num_of_theta_h * layout.num_of_theta_d;
  for (int c = 0; c < kChannels; ++c) {
    const LobesOfRow& lobes = accumulator->lobes[c];
    for (int m = 0; m < layout.spec.lobes; ++m) {
      f[1 + m] = model.F(m, c)[d];
      g[1 + m] = model.D(m, c)[h];
    }
    if (c == 0 || layout.spec.G.per_channel) {
      for (int m = 0; m < layout.spec.lobes; ++m) {
        std::copy_n(lobes[m].K, accumulator->padded_size,
                    &accumulator->phi_lines[static_cast<size_t>(1 + m) * layout.line_size]);
      }
      Transpose(basis, accumulator->padded_size, layout.line_size, accumulator->phi_lines.data(),
                accumulator->phi.data());
    }
    AddRowSums(accumulator->size, basis, accumulator->w[c].data(),
               accumulator->w_residual[c].data(), accumulator->phi.data(), f.data(), g.data(),
               sums.data(), &accumulator->theta_h_sums[c * layout.sums_size],
               accumulator->ThetaDSums(layout, d) + c * layout.sums_size);
    for (int m = 0; m < layout.spec.lobes; ++m) {
      double* const of_D = D_F + layout.D(m, c) * layout.num_of_theta_d;
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
void JointRows::SpreadThetaH(const FactorModel& model, Hessian hessian, int h,
                             RowAccumulator* accumulator) const {
  const RowLayout& layout = *layout_;
  const int lobes = layout.spec.lobes;
  std::array<Term, 1 + 2 * kMaxLobes> terms;
  for (int c = 0; c < kChannels; ++c) {
    terms[0] = {c, 0, 1};
    for (int m = 0; m < lobes; ++m) {
      terms[1 + m] = {RowLayout::s(m, c), 1 + m, model.D(m, c)[h]};
      terms[1 + lobes + m] = {layout.D(m, c), 1 + m, model.s(m)[c]};
    }
    const double* const A = &accumulator->theta_h_sums[c * layout.sums_size];
    const double* const b = A + layout.basis * layout.basis;
    for (int i = 0; i < 1 + 2 * lobes; ++i) {
      const Term& p = terms[i];
      accumulator->theta_h_gradient[p.parameter] += p.value * b[p.a];
      for (int j = i; j < 1 + 2 * lobes; ++j) {
        const Term& q = terms[j];
        const double product = p.value * q.value * A[p.a * layout.basis + q.a];
        accumulator
            ->theta_h_H[static_cast<size_t>(p.parameter) * layout.num_of_theta_h + q.parameter] +=
            i != j && p.parameter == q.parameter ? 2 * product : product;
      }
    }
    for (int m = 0; m < lobes && hessian == Hessian::kNewton; ++m) {
      accumulator->theta_h_H[static_cast<size_t>(RowLayout::s(m, c)) * layout.num_of_theta_h +
                             layout.D(m, c)] += b[1 + m];
    }
  }
  std::ranges::fill(accumulator->theta_h_sums, 0.0);
}

// Hands over what the rows of one theta_h added up for D, and clears that for the next.
void JointRows::TakeThetaH(const FactorModel& model, int h, RowAccumulator* accumulator,
                           QuadraticModel* result) const {
  const RowLayout& layout = *layout_;
  const ModelSpec& spec = layout.spec;
  const size_t n = result->gradient.size();
  const auto move = [](double* from, double* target) { *target = std::exchange(*from, 0.0); };
  for (int j = 0; j < spec.num_tables(Factor::kD); ++j) {
    const int of_D = layout.first_D + j;
    const size_t k = model.TableOffset(Factor::kD, j) + h;
    double* const row = &result->H[k * n];
    move(&accumulator->theta_h_gradient[of_D], &result->gradient[k]);
    for (int i = 0; i < layout.first_D; ++i) {
      move(&accumulator->theta_h_H[i * layout.num_of_theta_h + of_D], &result->H[i * n + k]);
    }
    for (int i = j; i < spec.num_tables(Factor::kD); ++i) {
      move(&accumulator->theta_h_H[of_D * layout.num_of_theta_h + layout.first_D + i],
           &row[model.TableOffset(Factor::kD, i) + h]);
    }
    result->squared_lengths[k] = row[k];
    for (int d = 0; d < spec.f_axis.size; ++d) {
      double* const D_F =
          &accumulator->D_F[(static_cast<size_t>(d) * layout.num_of_theta_h + of_D) *
                            layout.num_of_theta_d];
      for (int f = 0; f < layout.num_of_theta_d; ++f) {
        move(&D_F[f], &row[model.TableOffset(Factor::kF, f) + d]);
      }
    }
    for (size_t t = 0; t < layout.tables.size(); ++t) {
      const RowLayout::OfTable& table = layout.tables[t];
      if (table.theta_h_line[of_D] < 0) continue;
      double* sum = accumulator->theta_h_G.data() + table.theta_h_begin + table.theta_h_line[of_D];
      double* const target = &row[model.TableOffset(Factor::kG, static_cast<int>(t))];
      for (int node = -1; node <= spec.g_axis.size; ++node, sum += table.theta_h_lines) {
        const double value = std::exchange(*sum, 0.0);
        if (node >= 0 && node < spec.g_axis.size) target[node] = value;
      }
    }
  }
}

// Hands over what the rows of one theta_d added up for F.
void JointRows::SetThetaD(const FactorModel& model, Hessian hessian, int d,
                          QuadraticModel* result) const {
  const RowLayout& layout = *layout_;
  const int lobes = layout.spec.lobes;
  RowAccumulator& sum = *accumulators_[0];
  for (size_t s = 1; s < accumulators_.size(); ++s) {
    RowAccumulator& other = *accumulators_[s];
    AddTo(static_cast<size_t>(kChannels) * layout.sums_size, other.ThetaDSums(layout, d),
          sum.ThetaDSums(layout, d));
    AddTo(layout.theta_d_size, other.ThetaDG(layout, d), sum.ThetaDG(layout, d));
  }
  const size_t n = result->gradient.size();
  for (int c = 0; c < kChannels; ++c) {
    const double* const A = sum.ThetaDSums(layout, d) + c * layout.sums_size;
    const double* const b = A + layout.basis * layout.basis;
    for (int m = 0; m < lobes; ++m) {
      const size_t k = model.TableOffset(Factor::kF, layout.F(m, c)) + d;
      const double s_m = model.s(m)[c];
      const double* const A_m = A + (1 + m) * layout.basis;
      result->gradient[k] += s_m * b[1 + m];
      result->H[c * n + k] += s_m * A_m[0];
      for (int l = 0; l < lobes; ++l) {
        const size_t k_l = model.TableOffset(Factor::kF, layout.F(l, c)) + d;
        result->H[RowLayout::s(l, c) * n + k] += s_m * model.F(l, c)[d] * A_m[1 + l];
        if (k <= k_l) result->H[k * n + k_l] += s_m * model.s(l)[c] * A_m[1 + l];
      }
      if (hessian == Hessian::kNewton) result->H[RowLayout::s(m, c) * n + k] += b[1 + m];
    }
  }
  for (int f = 0; f < layout.num_of_theta_d; ++f) {
    const size_t k = model.TableOffset(Factor::kF, f) + d;
    double* const row = &result->H[k * n];
    result->squared_lengths[k] = row[k];
    for (size_t t = 0; t < layout.tables.size(); ++t) {
      const RowLayout::OfTable& table = layout.tables[t];
      if (table.theta_d_line[f] < 0) continue;
      const double* const sums =
          sum.ThetaDG(layout, d) + table.theta_d_begin + table.theta_d_line[f];
      double* const target = &row[model.TableOffset(Factor::kG, static_cast<int>(t))];
      for (int node = 0; node < layout.spec.g_axis.size; ++node) {
        target[node] = sums[(1 + node) * table.theta_d_lines];
      }
    }
  }
}

// Hands over what all rows added up for d and s, and the gradient of G.
void JointRows::SetAmplitudes(const FactorModel& model, QuadraticModel* result) const {
  const RowLayout& layout = *layout_;
  RowAccumulator& sum = *accumulators_[0];
  for (size_t s = 1; s < accumulators_.size(); ++s) {
    RowAccumulator& other = *accumulators_[s];
    sum.objective += other.objective;
    AddTo(sum.theta_h_H.size(), other.theta_h_H.data(), sum.theta_h_H.data());
    AddTo(sum.theta_h_gradient.size(), other.theta_h_gradient.data(), sum.theta_h_gradient.data());
    AddTo(layout.theta_h_size, other.theta_h_G.data(), sum.theta_h_G.data());
  }
  result->objective = folded_.constant + sum.objective;
  const size_t n = result->gradient.size();
  for (int k = 0; k < layout.first_D; ++k) {
    double* const row = &result->H[k * n];
    result->gradient[k] = sum.theta_h_gradient[k];
    for (int i = k; i < layout.first_D; ++i) row[i] = sum.theta_h_H[k * layout.num_of_theta_h + i];
    result->squared_lengths[k] = row[k];
  }
  for (size_t t = 0; t < layout.tables.size(); ++t) {
    const RowLayout::OfTable& table = layout.tables[t];
    const int offset = model.TableOffset(Factor::kG, static_cast<int>(t));
    const double* const sums = sum.theta_h_G.data() + table.theta_h_begin;
    for (int node = 0; node < layout.spec.g_axis.size; ++node) {
      const double* const of_node = sums + (1 + node) * table.theta_h_lines;
      result->gradient[offset + node] = of_node[table.gradient_line];
      for (int k = 0; k < layout.first_D; ++k) {
        if (table.theta_h_line[k] < 0) continue;
        result->H[k * n + offset + node] = of_node[table.theta_h_line[k]];
      }
    }
  }
}

void JointRows::Evaluate(const FactorModel& model, Hessian hessian, int num_threads,
                         QuadraticModel* result) {
  const auto G = ShadowingPieces(model);
  const int count = static_cast<int>(accumulators_.size());
  ParallelFor(count, num_threads, [&](int s) {
    RowAccumulator* const accumulator = accumulators_[s].get();
    accumulator->Clear();
    for (int h = s; h < folded_.grid.theta_h; h += count) {
      for (int d = 0; d < folded_.grid.theta_d; ++d) {
        const int row = h * folded_.grid.theta_d + d;
        if (folded_.row_begin[row] == folded_.row_begin[row + 1]) continue;
        ReadRow(model, G, h, d, accumulator);
        AddProducts(model, hessian, h, d, accumulator);
        AddCrossProducts(hessian, d, accumulator);
      }
      SpreadThetaH(model, hessian, h, accumulator);
      TakeThetaH(model, h, accumulator, result);
    }
  });
  ParallelFor(folded_.grid.theta_d, num_threads,
              [&](int d) { SetThetaD(model, hessian, d, result); });
  SetAmplitudes(model, result);
}

}  // namespace trilobe
