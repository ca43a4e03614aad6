#include "model/objective/batch_evaluator.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>

#include "core/base/multiversion.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// For the paper's sharing: one D and one G per lobe, one F per channel.
constexpr LaneLayout kByLobe{
    .per_lobe = true, .per_channel = false, .stride = kVector, .size = kVector};
constexpr LaneLayout kByChannel{
    .per_lobe = false, .per_channel = true, .stride = 1, .size = kVector};

// All that the loops over samples need.
struct ReadJob {
  int begin, end;
  BatchEvaluator::Slopes slopes;
  const FoldedSamples* samples;
  struct Lookup {
    const Cell* cells;
    const uint16_t* cell;
    std::array<const double*, Stencil::kMaxSize> weight;
    const double* table;
    int lanes;
    double* values;
    bool adds;  // to what is there: each stretch reads D of its own lobes
  };
  std::array<Lookup, LookupOrder::kMost> lookups;
  int num_lookups;
  LaneLayout D, F, G;
  const double *d, *s;
  int lobes, amplitude_lanes;
  double *residual, *amplitude, *D_slope, *F_slope, *shadow;
};

// The factors of all lobes in a channel.
template <int kBlocks>
TRILOBE_ALWAYS_INLINE void LobesOf(LaneLayout layout, int c, const double* lookup, Lanes4* lobes) {
  const double* const first = lookup + layout.First(c);
  for (int b = 0; b < kBlocks; ++b) {
    if (layout.per_lobe) {
      LoadLanes(first + kVector * b, &lobes[b]);
    } else {
      lobes[b] = Lanes4{} + *first;
    }
  }
}

template <int kBlocks>
TRILOBE_ALWAYS_INLINE double Sum(const Lanes4* lobes) {
  Lanes4 sum = lobes[0];
  for (int b = 1; b < kBlocks; ++b) sum += lobes[b];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

// The reverse of LobesOf, for derivatives.
template <int kBlocks>
TRILOBE_ALWAYS_INLINE void ToTables(LaneLayout layout, int c, const Lanes4* lobes, double* slope) {
  double* const first = slope + c * layout.size + layout.First(c);
  if (layout.per_lobe) {
    for (int b = 0; b < kBlocks; ++b) StoreLanes(lobes[b], first + kVector * b);
  } else {
    *first = Sum<kBlocks>(lobes);
  }
}

// Table properties known at compile time.
enum class Known {
  kNothing,
  kOneVector,     // all tables of each factor have their lanes in one vector
  kPaperSharing,  // and a lobe has one D and one G, a channel one F
};

template <int kBlocks, Known kKnown>
TRILOBE_ALWAYS_INLINE void ReadSamples(const ReadJob& job) {
  constexpr bool kOneVector = kKnown != Known::kNothing;
  constexpr bool kPaper = kKnown == Known::kPaperSharing;
  const LaneLayout D_lanes = kPaper ? kByLobe : job.D, F_lanes = kPaper ? kByChannel : job.F,
                   G_lanes = kPaper ? kByLobe : job.G;
  for (int j = job.begin; j < job.end; ++j) {
    const int n = j - job.begin;
    std::array<double*, LookupOrder::kMost> R;
    for (int r = 0; r < job.num_lookups; ++r) {
      const ReadJob::Lookup& lookup = job.lookups[r];
      const Cell& cell = lookup.cells[lookup.cell[j]];
      const int lanes = kOneVector ? kVector : lookup.lanes;
      R[r] = lookup.values + n * lanes;
      for (int b = 0; b < lanes; b += kVector) {
        Lanes4 sum = {};
        if (lookup.adds) LoadLanes(R[r] + b, &sum);
        for (int k = 0; k < cell.size; ++k) {
          Lanes4 entry;
          LoadLanes(lookup.table + cell.entry[k] * lanes + b, &entry);
          sum += lookup.weight[k][j] * entry;
        }
        StoreLanes(sum, R[r] + b);
      }
    }
    const double inverse_cosines = job.samples->inverse_cosines[j];
    for (int c = 0; c < kChannels; ++c) {
      Lanes4 D[kBlocks], F[kBlocks], G_i[kBlocks], G_o[kBlocks], of_s[kBlocks], x[kBlocks];
      LobesOf<kBlocks>(D_lanes, c, R[0], D);
      LobesOf<kBlocks>(F_lanes, c, R[job.num_lookups - 3], F);
      LobesOf<kBlocks>(G_lanes, c, R[job.num_lookups - 2], G_i);
      LobesOf<kBlocks>(G_lanes, c, R[job.num_lookups - 1], G_o);
      Lanes4 s[kBlocks], K[kBlocks];
      for (int b = 0; b < kBlocks; ++b) {
        LoadLanes(job.s + kVector * (c * kBlocks + b), &s[b]);
        K[b] = G_i[b] * G_o[b] * inverse_cosines;
        of_s[b] = D[b] * F[b] * K[b];
        x[b] = s[b] * of_s[b];
      }
      job.residual[n * kChannels + c] = job.d[c] + Sum<kBlocks>(x) - job.samples->rho[c][j];
      if (job.slopes == BatchEvaluator::Slopes::kNone) continue;
      Lanes4 of_D[kBlocks], of_F[kBlocks], of_G[kBlocks];
      for (int b = 0; b < kBlocks; ++b) {
        const Lanes4 sK = s[b] * K[b];
        of_D[b] = sK * F[b];
        of_F[b] = sK * D[b];
        of_G[b] = s[b] * (D[b] * F[b]) * inverse_cosines;
      }
      double* const amplitude = job.amplitude + (n * kChannels + c) * job.amplitude_lanes;
      for (int b = 0; b < kBlocks; ++b) StoreLanes(of_s[b], amplitude + kVector * b);
      amplitude[job.lobes] = 1;
      const int slope = n * kChannels;
      ToTables<kBlocks>(D_lanes, c, of_D, job.D_slope + slope * D_lanes.size);
      ToTables<kBlocks>(F_lanes, c, of_F, job.F_slope + slope * F_lanes.size);
      ToTables<kBlocks>(G_lanes, c, of_G, job.shadow + slope * G_lanes.size);
    }
  }
}

TRILOBE_MULTIVERSION
void ReadPaperSharing(const ReadJob& job) { ReadSamples<1, Known::kPaperSharing>(job); }
TRILOBE_MULTIVERSION
void ReadOneVector(const ReadJob& job) { ReadSamples<1, Known::kOneVector>(job); }
TRILOBE_MULTIVERSION
void ReadFourLobes(const ReadJob& job) { ReadSamples<1, Known::kNothing>(job); }
TRILOBE_MULTIVERSION
void ReadEightLobes(const ReadJob& job) { ReadSamples<2, Known::kNothing>(job); }
static_assert(kMaxLobes <= 2 * kVector);

}  // namespace

TableLanes::TableLanes(const ModelSpec& spec, Factor factor)
    : LaneLayout{.per_lobe = spec.sharing(factor).per_lobe || spec.lobes == 0,
                 .per_channel = spec.sharing(factor).per_channel} {
  const int lobe_lanes = std::max(PaddedToVectors(spec.lobes), kVector);
  stride = per_lobe ? lobe_lanes : 1;
  size = PaddedToVectors(per_channel ? kChannels * stride : stride);
  of_table.resize(spec.num_tables(factor));
  for (int c = 0; c < kChannels; ++c) {
    for (int m = 0; m < spec.lobes; ++m) {
      of_table[spec.table(factor, m, c)] = First(c) + (per_lobe ? m : 0);
    }
  }
}

BatchEvaluator::Batch::Batch(const BatchEvaluator& reader)
    : residual(kBatch * kChannels), amplitude(kBatch * kChannels * reader.amplitude_lanes()) {
  D.resize(kBatch * reader.lanes(Factor::kD).size);
  F.resize(kBatch * reader.lanes(Factor::kF).size);
  G_i.resize(kBatch * reader.lanes(Factor::kG).size);
  G_o.resize(kBatch * reader.lanes(Factor::kG).size);
  D_slope.resize(kBatch * kChannels * reader.lanes(Factor::kD).size);
  F_slope.resize(kBatch * kChannels * reader.lanes(Factor::kF).size);
  shadow.resize(kBatch * kChannels * reader.lanes(Factor::kG).size);
}

BatchEvaluator::BatchEvaluator(const FoldedSamples& samples, const ModelSpec& spec)
    : samples_(samples),
      spec_(spec),
      lobe_lanes_(std::max(PaddedToVectors(spec.lobes), kVector)),
      one_vector_(lobe_lanes_ == kVector),
      s_(kChannels * lobe_lanes_) {
  for (const Factor factor : kFactors) {
    const TableLanes lanes(spec, factor);
    const int count = factor == Factor::kD ? samples.order.of_D : 1;
    for (int k = 0; k < count; ++k) tables_.emplace_back(spec.table_size(factor) * lanes.size);
    lanes_[static_cast<int>(factor)] = lanes;
    one_vector_ = one_vector_ && lanes.size == kVector;
  }
}

int BatchEvaluator::LookupOf(Factor factor, int table) const {
  const LookupOrder& order = samples_.order;
  if (factor == Factor::kF) return order.F();
  if (factor == Factor::kG) return order.G_i();
  return spec_.StretchOfTable(table);
}

void BatchEvaluator::SetModel(const FactorModel& model) {
  for (const Factor factor : kFactors) {
    const TableLanes& layout = lanes(factor);
    for (int t = 0; t < spec_.num_tables(factor); ++t) {
      const std::span<const double> table = model.table(factor, t);
      std::vector<double>& target = tables_[LookupOf(factor, t)];
      for (size_t k = 0; k < table.size(); ++k) {
        target[k * layout.size + layout.of_table[t]] = table[k];
      }
    }
  }
  for (int c = 0; c < kChannels; ++c) {
    d_[c] = model.d()[c];
    for (int m = 0; m < spec_.lobes; ++m) s_[c * lobe_lanes_ + m] = model.s(m)[c];
  }
}

void BatchEvaluator::Read(int begin, int end, Slopes slopes, Batch* batch) const {
  ReadJob job{.begin = begin,
              .end = end,
              .slopes = slopes,
              .samples = &samples_,
              .lookups = {},
              .num_lookups = samples_.order.count(),
              .D = lanes(Factor::kD),
              .F = lanes(Factor::kF),
              .G = lanes(Factor::kG),
              .d = d_.data(),
              .s = s_.data(),
              .lobes = spec_.lobes,
              .amplitude_lanes = amplitude_lanes(),
              .residual = batch->residual.data(),
              .amplitude = batch->amplitude.data(),
              .D_slope = batch->D_slope.data(),
              .F_slope = batch->F_slope.data(),
              .shadow = batch->shadow.data()};
  const LookupOrder& order = samples_.order;
  for (int r = 0; r < order.count(); ++r) {
    const Factor factor = order.factor(r);
    std::vector<double>& lookup = r < order.F()      ? batch->D
                                  : r == order.F()   ? batch->F
                                  : r == order.G_i() ? batch->G_i
                                                     : batch->G_o;
    job.lookups[r] = {.cells = samples_.cells_of(factor).data(),
                      .cell = samples_.lookups[r].cell.data(),
                      .weight = {},
                      .table = tables_[std::min(r, order.G_i())].data(),
                      .lanes = lanes(factor).size,
                      .values = lookup.data(),
                      .adds = r > 0 && r < order.F()};
    const std::vector<std::vector<double>>& weight = samples_.lookups[r].weight;
    for (size_t k = 0; k < weight.size(); ++k) job.lookups[r].weight[k] = weight[k].data();
  }
  if (one_vector_ && job.D == kByLobe && job.F == kByChannel && job.G == kByLobe) {
    ReadPaperSharing(job);
  } else if (one_vector_) {
    ReadOneVector(job);
  } else if (lobe_lanes_ == kVector) {
    ReadFourLobes(job);
  } else {
    ReadEightLobes(job);
  }
}

namespace {

constexpr int kSummedAtOnce = 64 * BatchEvaluator::kBatch;

// E of samples [begin, end), without the constant.
double ValueOf(const BatchEvaluator& reader, int begin, int end) {
  BatchEvaluator::Batch batch(reader);
  double sum = 0;
  for (int first = begin; first < end; first += BatchEvaluator::kBatch) {
    const int last = std::min(first + BatchEvaluator::kBatch, end);
    reader.Read(first, last, BatchEvaluator::Slopes::kNone, &batch);
    for (int j = first; j < last; ++j) {
      for (int c = 0; c < kChannels; ++c) {
        const double residual = batch.residual[(j - first) * kChannels + c];
        sum += reader.samples().weight[c][j] * residual * residual;
      }
    }
  }
  return sum;
}

// constant + the values of chunks of so many samples, in order.
template <typename Value>
double SumOfChunks(int size, double constant, int num_threads, const Value& value) {
  std::vector<double> sums((size + kSummedAtOnce - 1) / kSummedAtOnce);
  ParallelFor(static_cast<int>(sums.size()), num_threads, [&](int k) {
    sums[k] = value(k * kSummedAtOnce, std::min((k + 1) * kSummedAtOnce, size));
  });
  return std::accumulate(sums.begin(), sums.end(), constant);
}

}  // namespace

double FoldedValue(const FoldedSamples& samples, const FactorModel& model, int num_threads) {
  BatchEvaluator reader(samples, model.spec());
  reader.SetModel(model);
  return SumOfChunks(samples.size(), samples.constant, num_threads,
                     [&](int begin, int end) { return ValueOf(reader, begin, end); });
}

double FoldedValue(const FoldedPart& part, const FactorModel& model, int num_threads) {
  return SumOfChunks(part.size(), part.constant, num_threads, [&](int begin, int end) {
    const FoldedSamples some = Gathered(part, begin, end);
    BatchEvaluator reader(some, model.spec());
    reader.SetModel(model);
    return ValueOf(reader, 0, some.size());
  });
}

}  // namespace trilobe
