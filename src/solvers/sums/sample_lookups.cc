#include "solvers/sums/sample_lookups.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/multiversion.h"
#include "model/objective/batch_evaluator.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// At most kVector tables, side by side, and the values that `size` samples read from them.
struct ReadJob {
  int size;
  const Cell* cells;
  const uint16_t* cell;                                 // [size]
  std::array<const double*, Stencil::kMaxSize> weight;  // [size]
  const double* table;                                  // [entries][kVector]
  int tables;
  std::array<double*, kVector> target;  // [size]
};

TRILOBE_MULTIVERSION
void ReadTables(const ReadJob& job) {
  for (int n = 0; n < job.size; ++n) {
    const Cell& cell = job.cells[job.cell[n]];
    Lanes4 sum = {};
    for (int k = 0; k < cell.size; ++k) {
      Lanes4 entry;
      LoadLanes(job.table + cell.entry[k] * kVector, &entry);
      sum += job.weight[k][n] * entry;
    }
    for (int t = 0; t < job.tables; ++t) job.target[t][n] = sum[t];
  }
}

// Inputs and outputs of one lobe for samples of one channel.
struct LobeJob {
  int size;
  double s;
  const double *D, *F, *G_i, *G_o, *inverse_cosines;
  double *slope, *residual;
};

// slope += the lobe's value over what it reads of a kind, residual += its value.
template <ParameterKind kKind>
TRILOBE_ALWAYS_INLINE void AddLobe(const LobeJob& job) {
  const double s = job.s;
  const double* __restrict const D = job.D;
  const double* __restrict const F = job.F;
  const double* __restrict const G_i = job.G_i;
  const double* __restrict const G_o = job.G_o;
  const double* __restrict const inverse_cosines = job.inverse_cosines;
  double* __restrict const slope = job.slope;
  double* __restrict const residual = job.residual;
  for (int n = 0; n < job.size; ++n) {
    const double G = G_i[n] * G_o[n], K = G * inverse_cosines[n];
    double others, own;
    switch (kKind) {
      case ParameterKind::kAmplitudes:
        others = D[n] * F[n] * K;
        own = s;
        break;
      case ParameterKind::kD:
        others = s * K * F[n];
        own = D[n];
        break;
      case ParameterKind::kF:
        others = s * K * D[n];
        own = F[n];
        break;
      default:
        others = s * (D[n] * F[n]) * inverse_cosines[n];
        own = G;
    }
    slope[n] += others;
    residual[n] += own * others;
  }
}

TRILOBE_MULTIVERSION void AddByAmplitude(const LobeJob& job) {
  AddLobe<ParameterKind::kAmplitudes>(job);
}
TRILOBE_MULTIVERSION void AddByD(const LobeJob& job) { AddLobe<ParameterKind::kD>(job); }
TRILOBE_MULTIVERSION void AddByF(const LobeJob& job) { AddLobe<ParameterKind::kF>(job); }
TRILOBE_MULTIVERSION void AddByG(const LobeJob& job) { AddLobe<ParameterKind::kG>(job); }

// slope += that of a lobe in G_i G_o.
TRILOBE_MULTIVERSION
void AddSlopeInG(int size, double s, const double* __restrict D, const double* __restrict F,
                 const double* __restrict inverse_cosines, double* __restrict slope) {
  for (int n = 0; n < size; ++n) slope[n] += s * (D[n] * F[n]) * inverse_cosines[n];
}

}  // namespace

SampleLookups::Batch::Batch(const ModelSpec& spec, ParameterKind kind)
    : kind(kind),
      tables(kind == ParameterKind::kAmplitudes ? 1 + spec.lobes : spec.num_tables(FactorOf(kind))),
      residual(kChannels * kBatch),
      slope(kChannels * tables * kBatch),
      D(spec.num_tables(Factor::kD) * kBatch),
      F(spec.num_tables(Factor::kF) * kBatch),
      G_i(spec.num_tables(Factor::kG) * kBatch),
      G_o(G_i) {}

SampleLookups::SampleLookups(const FoldedSamples& samples, const ModelSpec& spec, int num_threads)
    : samples_(samples), spec_(spec), num_threads_(num_threads) {
  for (const Factor factor : kFactors) {
    const int tables = spec.num_tables(factor);
    for (int first = 0; first < tables;) {
      const int end = factor == Factor::kD ? EndOfStretch(first) : tables;
      const int last = std::min(end, first + kVector);
      groups_.push_back(
          {factor, first, last,
           std::vector<double>(static_cast<size_t>(spec.table_size(factor)) * kVector)});
      first = last;
    }
  }
}

void SampleLookups::ForChunks(const std::function<void(int, int)>& work) const {
  constexpr int kChunk = 64 * kBatch;
  ParallelFor((samples_.size() + kChunk - 1) / kChunk, num_threads_,
              [&](int k) { work(k * kChunk, std::min((k + 1) * kChunk, samples_.size())); });
}

int SampleLookups::EndOfStretch(int d_table) const {
  int end = d_table + 1;
  while (end < spec_.num_tables(Factor::kD) &&
         spec_.StretchOfTable(end) == spec_.StretchOfTable(d_table)) {
    ++end;
  }
  return end;
}

void SampleLookups::SetTables(const FactorModel& model) {
  for (Group& group : groups_) {
    for (int t = group.first; t < group.last; ++t) {
      const std::span<const double> from = model.table(group.factor, t);
      for (size_t k = 0; k < from.size(); ++k) {
        group.values[k * kVector + t - group.first] = from[k];
      }
    }
  }
}

void SampleLookups::ReadBy(int lookup, const Group& group, int begin, int end, double* target,
                           int first_target, int stride) const {
  const FoldedSamples::Lookup& weights = samples_.lookups[lookup];
  ReadJob job{.size = end - begin,
              .cells = samples_.cells_of(group.factor).data(),
              .cell = &weights.cell[begin],
              .weight = {},
              .table = group.values.data(),
              .tables = group.last - group.first,
              .target = {}};
  for (size_t k = 0; k < weights.weight.size(); ++k) job.weight[k] = &weights.weight[k][begin];
  for (int t = 0; t < job.tables; ++t) {
    job.target[t] = target + static_cast<ptrdiff_t>(group.first + t - first_target) * stride;
  }
  ReadTables(job);
}

void SampleLookups::ReadBatch(bool with_G, int begin, int end, Batch* batch) const {
  const LookupOrder& order = samples_.order;
  for (const Group& group : groups_) {
    switch (group.factor) {
      case Factor::kD:
        ReadBy(spec_.StretchOfTable(group.first), group, begin, end, batch->D.data(), 0, kBatch);
        break;
      case Factor::kF:
        ReadBy(order.F(), group, begin, end, batch->F.data(), 0, kBatch);
        break;
      case Factor::kG:
        if (!with_G) break;
        ReadBy(order.G_i(), group, begin, end, batch->G_i.data(), 0, kBatch);
        ReadBy(order.G_o(), group, begin, end, batch->G_o.data(), 0, kBatch);
    }
  }
}

void SampleLookups::ReadG(int table, std::vector<double>* G_i, std::vector<double>* G_o) const {
  const LookupOrder& order = samples_.order;
  Group alone{Factor::kG, table, table + 1, {}};
  for (const Group& group : groups_) {
    if (group.factor != Factor::kG || table < group.first || table >= group.last) continue;
    alone.values.resize(group.values.size());
    for (size_t k = 0; k < group.values.size(); k += kVector) {
      alone.values[k] = group.values[k + table - group.first];
    }
  }
  G_i->resize(samples_.size());
  G_o->resize(samples_.size());
  ForChunks([&](int begin, int end) {
    ReadBy(order.G_i(), alone, begin, end, G_i->data() + begin, table, 0);
    ReadBy(order.G_o(), alone, begin, end, G_o->data() + begin, table, 0);
  });
}

void SampleLookups::SlopesInG(int table, int begin, int end, const FactorModel& model,
                              Batch* batch) const {
  ReadBatch(/*with_G=*/false, begin, end, batch);
  const auto [first, last] = spec_.channels(Factor::kG, table);
  for (int c = first; c < last; ++c) {
    double* const slope = batch->Slope(c, table);
    std::fill_n(slope, kBatch, 0.0);
    for (int m = 0; m < spec_.lobes; ++m) {
      if (spec_.table(Factor::kG, m, c) != table) continue;
      AddSlopeInG(end - begin, model.s(m)[c], &batch->D[spec_.table(Factor::kD, m, c) * kBatch],
                  &batch->F[spec_.table(Factor::kF, m, c) * kBatch],
                  &samples_.inverse_cosines[begin], slope);
    }
  }
}

void SampleLookups::Evaluate(int begin, int end, const FactorModel& model, Batch* batch) const {
  ReadBatch(/*with_G=*/true, begin, end, batch);
  const ParameterKind kind = batch->kind;
  const int size = end - begin;
  std::ranges::fill(batch->slope, 0.0);
  const auto add = kind == ParameterKind::kAmplitudes ? AddByAmplitude
                   : kind == ParameterKind::kD        ? AddByD
                   : kind == ParameterKind::kF        ? AddByF
                                                      : AddByG;
  for (int c = 0; c < kChannels; ++c) {
    double* const residual = &batch->residual[c * kBatch];
    for (int n = 0; n < size; ++n) residual[n] = model.d()[c] - samples_.rho[c][begin + n];
    if (kind == ParameterKind::kAmplitudes) std::fill_n(batch->Slope(c, 0), size, 1.0);
    for (int m = 0; m < spec_.lobes; ++m) {
      const int G = spec_.table(Factor::kG, m, c);
      const int t = kind == ParameterKind::kAmplitudes ? 1 + m : spec_.table(FactorOf(kind), m, c);
      add({.size = size,
           .s = model.s(m)[c],
           .D = &batch->D[spec_.table(Factor::kD, m, c) * kBatch],
           .F = &batch->F[spec_.table(Factor::kF, m, c) * kBatch],
           .G_i = &batch->G_i[G * kBatch],
           .G_o = &batch->G_o[G * kBatch],
           .inverse_cosines = &samples_.inverse_cosines[begin],
           .slope = batch->Slope(c, t),
           .residual = residual});
    }
  }
}

}  // namespace trilobe
