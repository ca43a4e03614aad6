#include "solvers/sums/cached_lookups.h"

#include <algorithm>
#include <array>
#include <span>

#include "core/base/multiversion.h"
#include "model/objective/batch_evaluator.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// Up to kVector tables, side by side, and what samples [begin, end) read from them.
struct ReadJob {
  int begin, end;
  const Cell* cells;
  const int* cell;                                      // [samples]
  std::array<const double*, Stencil::kMaxSize> weight;  // [samples]
  const double* table;                                  // [entries][kVector]
  int tables;
  std::array<double*, kVector> target;  // [samples]
};

TRILOBE_MULTIVERSION
void ReadTables(const ReadJob& job) {
  for (int j = job.begin; j < job.end; ++j) {
    const Cell& cell = job.cells[job.cell[j]];
    Lanes4 sum = {};
    for (int k = 0; k < cell.size; ++k) {
      Lanes4 entry;
      LoadLanes(job.table + cell.entry[k] * kVector, &entry);
      sum += job.weight[k][j] * entry;
    }
    for (int t = 0; t < job.tables; ++t) job.target[t][j] = sum[t];
  }
}

// What a lobe has to do with samples of one channel.
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

}  // namespace

CachedLookups::Batch::Batch(const ModelSpec& spec, ParameterKind kind)
    : kind(kind),
      tables(kind == ParameterKind::kAmplitudes ? 1 + spec.lobes : spec.num_tables(FactorOf(kind))),
      residual(kChannels * kBatch),
      slope(kChannels * tables * kBatch) {}

CachedLookups::CachedLookups(const FoldedSamples& samples, const ModelSpec& spec, int num_threads)
    : samples_(samples), spec_(spec), num_threads_(num_threads) {
  const std::vector<double> zeros(samples.size());
  D_.assign(spec.num_tables(Factor::kD), zeros);
  F_.assign(spec.num_tables(Factor::kF), zeros);
  G_i_.assign(spec.num_tables(Factor::kG), zeros);
  G_o_ = G_i_;
}

void CachedLookups::ForChunks(const std::function<void(int, int)>& work) const {
  constexpr int kChunk = 64 * kBatch;
  ParallelFor((samples_.size() + kChunk - 1) / kChunk, num_threads_,
              [&](int k) { work(k * kChunk, std::min((k + 1) * kChunk, samples_.size())); });
}

int CachedLookups::EndOfStretch(int d_table) const {
  int end = d_table + 1;
  while (end < spec_.num_tables(Factor::kD) &&
         spec_.StretchOfTable(end) == spec_.StretchOfTable(d_table)) {
    ++end;
  }
  return end;
}

void CachedLookups::Read(const FactorModel& model) {
  for (const Factor factor : kFactors) Read(model, factor, 0, spec_.num_tables(factor));
}

void CachedLookups::Read(const FactorModel& model, Factor factor, int first, int last) {
  const LookupOrder& order = samples_.order;
  switch (factor) {
    case Factor::kD:
      for (int t = first; t < last;) {
        const int end = std::min(last, EndOfStretch(t));
        ReadBy(spec_.StretchOfTable(t), model, t, end, &D_);
        t = end;
      }
      break;
    case Factor::kF:
      ReadBy(order.F(), model, first, last, &F_);
      break;
    case Factor::kG:
      ReadBy(order.G_i(), model, first, last, &G_i_);
      ReadBy(order.G_o(), model, first, last, &G_o_);
  }
}

void CachedLookups::ReadBy(int lookup, const FactorModel& model, int first, int last,
                           std::vector<std::vector<double>>* target) {
  const Factor factor = samples_.order.factor(lookup);
  const FoldedSamples::Lookup& weights = samples_.lookups[lookup];
  std::vector<double> table(static_cast<size_t>(spec_.table_size(factor)) * kVector);
  for (; first < last; first += kVector) {
    ReadJob job{};
    job.cells = samples_.cells_of(factor).data();
    job.cell = weights.cell.data();
    job.table = table.data();
    job.tables = std::min(kVector, last - first);
    for (size_t k = 0; k < weights.weight.size(); ++k) job.weight[k] = weights.weight[k].data();
    for (int t = 0; t < job.tables; ++t) {
      const std::span<const double> from = model.table(factor, first + t);
      for (size_t k = 0; k < from.size(); ++k) table[k * kVector + t] = from[k];
      job.target[t] = (*target)[first + t].data();
    }
    ForChunks([&](int begin, int end) {
      ReadJob chunk = job;
      chunk.begin = begin;
      chunk.end = end;
      ReadTables(chunk);
    });
  }
}

void CachedLookups::Evaluate(int begin, int end, const FactorModel& model, Batch* batch) const {
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
           .D = &D_[spec_.table(Factor::kD, m, c)][begin],
           .F = &F_[spec_.table(Factor::kF, m, c)][begin],
           .G_i = &G_i_[G][begin],
           .G_o = &G_o_[G][begin],
           .inverse_cosines = &samples_.inverse_cosines[begin],
           .slope = batch->Slope(c, t),
           .residual = residual});
    }
  }
}

}  // namespace trilobe
