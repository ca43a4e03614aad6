#include "solvers/sums/block_equations.h"

#include <algorithm>
#include <array>

#include "core/algebra/nonnegative_least_squares.h"
#include "core/base/multiversion.h"
#include "model/objective/batch_evaluator.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {
namespace {

constexpr int kAtOnce = SampleLookups::kBatch;
constexpr int kMostTables = kChannels * kMaxLobes;
// Tables of one channel have products with each other, those of different channels have none.
constexpr int kMostPairs = kChannels * kMaxLobes * (kMaxLobes + 1) / 2;

// sum += w x y.
TRILOBE_MULTIVERSION
void AddProducts(int size, const double* __restrict w, const double* __restrict x,
                 const double* __restrict y, double* __restrict sum) {
  for (int n = 0; n < size; ++n) sum[n] += w[n] * x[n] * y[n];
}

// Sum of w x y over all samples.
template <typename Eight>
TRILOBE_ALWAYS_INLINE double SumOfProductsBy(int size, const double* w, const double* x,
                                             const double* y) {
  constexpr int kLanes = 8;
  Eight lanes = {};
  const int whole = size - size % kLanes;
  for (int n = 0; n < whole; n += kLanes) {
    Eight w_n, x_n, y_n;
    LoadLanes(w + n, &w_n);
    LoadLanes(x + n, &x_n);
    LoadLanes(y + n, &y_n);
    lanes += w_n * x_n * y_n;
  }
  double sum = 0;
  for (int lane = 0; lane < kLanes; ++lane) sum += lanes[lane];
  for (int n = whole; n < size; ++n) sum += w[n] * x[n] * y[n];
  return sum;
}
double SumOfProducts(int size, const double* w, const double* x, const double* y) {
  TRILOBE_FOR_EIGHT(SumOfProductsBy, size, w, x, y);
}

// Samples on their way to the cells that they read.
struct SpreadJob {
  int size;
  const Cell* cells;
  const uint16_t* cell;                                 // [size]
  std::array<const double*, Stencil::kMaxSize> weight;  // [size]
  int tables, table_lanes, pairs, pair_lanes, pairs_in_cell;
  const double *slopes, *products;  // [tables or pairs][kAtOnce]
  double *of_entries, *of_cells;
};

TRILOBE_MULTIVERSION
void Spread(const SpreadJob& job) {
  alignas(sizeof(Lanes8)) double slope[PaddedToVectors(kMostTables)] = {};
  alignas(sizeof(Lanes8)) double product[PaddedToVectors(kMostPairs)] = {};
  for (int n = 0; n < job.size; ++n) {
    for (int t = 0; t < job.tables; ++t) slope[t] = job.slopes[t * kAtOnce + n];
    for (int p = 0; p < job.pairs; ++p) product[p] = job.products[p * kAtOnce + n];
    const Cell& cell = job.cells[job.cell[n]];
    double* target =
        job.of_cells + static_cast<ptrdiff_t>(job.cell[n]) * job.pairs_in_cell * job.pair_lanes;
    for (int k = 0; k < cell.size; ++k) {
      const double w = job.weight[k][n];
      AddScaled(job.table_lanes, w, slope,
                job.of_entries + static_cast<ptrdiff_t>(cell.entry[k]) * job.table_lanes);
      for (int l = 0; l <= k; ++l, target += job.pair_lanes) {
        AddScaled(job.pair_lanes, w * job.weight[l][n], product, target);
      }
    }
  }
}

}  // namespace

BlockEquations::BlockEquations(const SampleLookups& lookups, ParameterKind kind, int first,
                               int last)
    : lookups_(lookups), kind_(kind), first_(first), last_(last) {
  const ModelSpec& spec = lookups.spec();
  const auto channels = [&](int t) -> ModelSpec::ChannelRange {
    if (kind == ParameterKind::kAmplitudes) return {0, kChannels};
    return spec.channels(FactorOf(kind), first + t);
  };
  pair_of_.assign(tables() * tables(), -1);
  for (int u = 0; u < tables(); ++u) {
    for (int t = 0; t <= u; ++t) {
      const ModelSpec::ChannelRange common{std::max(channels(t).begin, channels(u).begin),
                                           std::min(channels(t).end, channels(u).end)};
      if (common.begin >= common.end) continue;
      pair_of_[t * tables() + u] = pair_of_[u * tables() + t] = static_cast<int>(pairs_.size());
      pairs_.push_back({t, u, common});
    }
  }
  if (kind == ParameterKind::kAmplitudes) {
    for (int c = 0; c < kChannels; ++c) cells_.push_back({.size = 1, .entry = {c}});
    readers_.resize(kChannels);
  } else {
    cells_ = lookups.samples().cells_of(FactorOf(kind));
    readers_.resize(spec.table_size(FactorOf(kind)));
  }
  int most = 1;
  for (size_t number = 0; number < cells_.size(); ++number) {
    const Cell& cell = cells_[number];
    most = std::max(most, cell.size);
    for (int k = 0; k < cell.size; ++k) {
      readers_[cell.entry[k]].push_back({static_cast<int>(number), k});
    }
  }
  table_lanes_ = PaddedToVectors(tables());
  pair_lanes_ = PaddedToVectors(static_cast<int>(pairs_.size()));
  pairs_in_cell_ = most * (most + 1) / 2;
  of_cells_ = readers_.size() * table_lanes_;
  sums_.resize(NumAccumulators(lookups.samples().size()));
}

void BlockEquations::Accumulate(const FactorModel& model) {
  const int count = static_cast<int>(sums_.size());
  ParallelFor(count, lookups_.num_threads(), [&](int k) {
    std::vector<double>& sums = sums_[k];
    sums.assign(of_cells_ + cells_.size() * pairs_in_cell_ * pair_lanes_, 0.0);
    const int64_t size = lookups_.samples().size();
    const int last = static_cast<int>(size * (k + 1) / count);
    SampleLookups::Batch batch(lookups_.spec(), kind_);
    for (int begin = static_cast<int>(size * k / count); begin < last; begin += kAtOnce) {
      const int end = std::min(begin + kAtOnce, last);
      lookups_.Evaluate(begin, end, model, &batch);
      if (kind_ == ParameterKind::kAmplitudes) {
        AddAmplitudes(begin, end, batch, &sums);
      } else {
        AddBatch(begin, end, batch, &sums);
      }
    }
  });
  for (int k = 1; k < count; ++k) {
    for (size_t i = 0; i < sums_[0].size(); ++i) sums_[0][i] += sums_[k][i];
  }
}

void BlockEquations::AddAmplitudes(int begin, int end, const SampleLookups::Batch& batch,
                                   std::vector<double>* sums) const {
  const int size = end - begin;
  for (int c = 0; c < kChannels; ++c) {
    const double* const w = &lookups_.samples().weight[c][begin];
    for (int t = 0; t < tables(); ++t) {
      (*sums)[c * table_lanes_ + t] +=
          SumOfProducts(size, w, &batch.residual[c * kAtOnce], batch.Slope(c, t));
    }
    double* const of_cell = &(*sums)[InCell(c, 0, 0)];
    for (size_t p = 0; p < pairs_.size(); ++p) {
      of_cell[p] +=
          SumOfProducts(size, w, batch.Slope(c, pairs_[p].t), batch.Slope(c, pairs_[p].u));
    }
  }
}

void BlockEquations::AddBatch(int begin, int end, const SampleLookups::Batch& batch,
                              std::vector<double>* sums) const {
  const FoldedSamples& samples = lookups_.samples();
  const int size = end - begin;
  std::array<double, kMostTables * kAtOnce> slopes;
  std::array<double, kMostPairs * kAtOnce> products;
  std::fill_n(slopes.begin(), tables() * kAtOnce, 0.0);
  std::fill_n(products.begin(), pairs_.size() * kAtOnce, 0.0);
  for (size_t p = 0; p < pairs_.size(); ++p) {
    const auto& [t, u, channels] = pairs_[p];
    for (int c = channels.begin; c < channels.end; ++c) {
      const double* const w = &samples.weight[c][begin];
      const double* const slope = batch.Slope(c, first_ + t);
      AddProducts(size, w, slope, batch.Slope(c, first_ + u), &products[p * kAtOnce]);
      if (t == u) AddProducts(size, w, &batch.residual[c * kAtOnce], slope, &slopes[t * kAtOnce]);
    }
  }
  const int lookup =
      kind_ == ParameterKind::kF ? samples.order.F() : lookups_.spec().StretchOfTable(first_);
  const FoldedSamples::Lookup& weights = samples.lookups[lookup];
  SpreadJob job{.size = size,
                .cells = cells_.data(),
                .cell = &weights.cell[begin],
                .weight = {},
                .tables = tables(),
                .table_lanes = table_lanes_,
                .pairs = static_cast<int>(pairs_.size()),
                .pair_lanes = pair_lanes_,
                .pairs_in_cell = pairs_in_cell_,
                .slopes = slopes.data(),
                .products = products.data(),
                .of_entries = sums->data(),
                .of_cells = sums->data() + of_cells_};
  for (size_t k = 0; k < weights.weight.size(); ++k) job.weight[k] = &weights.weight[k][begin];
  Spread(job);
}

void BlockEquations::Update(int entry, std::span<const int> tables, double E, FactorModel* model) {
  const size_t size = tables.size();
  std::array<double, kMaxNonnegativeUnknowns> g{}, steps{};
  std::array<double, kMaxNonnegativeUnknowns * kMaxNonnegativeUnknowns> H{};
  std::array<double*, kMaxNonnegativeUnknowns> parameters{};
  double* const sums = sums_[0].data();
  double* const of_kind = kind_ == ParameterKind::kAmplitudes
                              ? model->parameters().data()
                              : &model->parameters()[model->TableOffset(FactorOf(kind_), 0)];
  const auto pair_of = [&](int t, int u) {
    return pair_of_[(t - first_) * this->tables() + (u - first_)];
  };
  for (size_t a = 0; a < size; ++a) {
    parameters[a] = of_kind + static_cast<ptrdiff_t>(tables[a]) * entries() + entry;
    g[a] = -sums[entry * table_lanes_ + tables[a] - first_];
    for (size_t b = 0; b < size; ++b) {
      const int pair = pair_of(tables[a], tables[b]);
      if (pair < 0) continue;
      for (const auto& [cell, k] : readers_[entry]) {
        H[a * size + b] += sums[InCell(cell, k, k) + pair];
      }
    }
  }
  if (!MoveToMinimum({H.data(), size * size}, {g.data(), size}, E, {parameters.data(), size},
                     steps.data())) {
    return;
  }
  for (const auto& [number, k] : readers_[entry]) {
    const Cell& cell = cells_[number];
    for (int l = 0; l < cell.size; ++l) {
      const double* const of_pairs = sums + InCell(number, k, l);
      double* const gradient = sums + static_cast<ptrdiff_t>(cell.entry[l]) * table_lanes_;
      for (size_t a = 0; a < size; ++a) {
        for (int u = first_; u < last_; ++u) {
          const int pair = pair_of(tables[a], u);
          if (pair >= 0) gradient[u - first_] += steps[a] * of_pairs[pair];
        }
      }
    }
  }
}

}  // namespace trilobe
