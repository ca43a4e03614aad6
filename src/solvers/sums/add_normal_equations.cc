#include "solvers/sums/add_normal_equations.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/multiversion.h"
#include "solvers/sums/accumulators.h"

namespace trilobe {
namespace {

constexpr int kMaxLanes = kChannels * PaddedToVectors(kMaxLobes);

// The tables that a lookup reads, as columns of products: in what order, the lane of each, and the
// first channel that it serves.
struct Columns {
  struct Column {
    int lane, channel;
  };
  std::vector<Column> columns;
  // Offset of a lobe's products with itself among those with a later lookup; -1 if another stretch
  // reads that lobe. [order.count()][kChannels][lobes]
  std::vector<int> of_lobe;
};

// Inputs and sums shared by all samples.
struct SumJob {
  const BatchEvaluator* reader;
  const AccumulatorLayout* layout;
  LookupOrder order;
  std::vector<Columns> columns;  // [order.count()]
  double* sums;
};

// One lookup of a sample: how its value moves with it in each channel, and the same times w.
struct Slopes {
  const Cell* cell;
  const double* weight;                                           // of the cell's entries
  const double* value;                                            // [lanes]
  const double* slope;                                            // [kChannels][lanes]
  alignas(sizeof(Lanes8)) double w_slope[kChannels * kMaxLanes];  // slope times w
};

// Lanes of a row: as many as they are, or one vector, which the compiler then knows.
template <bool kOneVector>
TRILOBE_ALWAYS_INLINE int Lanes(int lanes) {
  return kOneVector ? kVector : lanes;
}

// y = sum_c x_c w_slope_c over all channels, x_c at x + c x_stride.
template <bool kOneVector>
TRILOBE_ALWAYS_INLINE void Combine(const double* x, int x_stride, const double* w_slope,
                                   int row_lanes, double* y) {
  static_assert(kChannels == 3);
  const int lanes = Lanes<kOneVector>(row_lanes);
  for (int b = 0; b < lanes; b += kVector) {
    Lanes4 w0, w1, w2;
    LoadLanes(w_slope + b, &w0);
    LoadLanes(w_slope + lanes + b, &w1);
    LoadLanes(w_slope + 2 * lanes + b, &w2);
    StoreLanes(x[0] * w0 + (x[x_stride] * w1 + x[2 * x_stride] * w2), y + b);
  }
}

// y = x_c w_slope_c of one channel.
template <bool kOneVector>
TRILOBE_ALWAYS_INLINE void Scale(int c, const double* x, int x_stride, const double* w_slope,
                                 int row_lanes, double* y) {
  const int lanes = Lanes<kOneVector>(row_lanes);
  const double x_c = x[c * x_stride];
  for (int b = 0; b < lanes; b += kVector) {
    Lanes4 w;
    LoadLanes(w_slope + c * lanes + b, &w);
    StoreLanes(x_c * w, y + b);
  }
}

// Lane of a factor's table that serves a lobe and channel.
TRILOBE_ALWAYS_INLINE int LaneOf(const TableLanes& lanes, int m, int c) {
  return lanes.First(c) + (lanes.per_lobe ? m : 0);
}

// Factors of a lobe: s and the lookups of D, F, G_i and G_o, in this order.
enum Part { kS, kOfD, kOfF, kOfG_i, kOfG_o, kParts };
TRILOBE_ALWAYS_INLINE int PartOf(const LookupOrder& order, int lookup) {
  return lookup < order.F() ? kOfD : kOfF + lookup - order.F();
}

struct Sample {
  int j;
  const double* residual;  // [kChannels]
  double w_residual[kChannels];
  const double* amplitude;  // [kChannels][amplitude lanes]
  Slopes lookups[LookupOrder::kMost];
  // w (rho - rho*) d2 rho / (d a d b) of each lobe and channel, for two of its parts, a < b: what
  // is left of s D F G_i G_o / (cos cos) without these. Set for second derivatives alone.
  alignas(sizeof(Lanes8)) double second[kParts][kParts][kChannels][PaddedToVectors(kMaxLobes)];
};

template <bool kOneVector>
TRILOBE_ALWAYS_INLINE void SetSecondDerivatives(const SumJob& job, Sample* at) {
  const BatchEvaluator& reader = *job.reader;
  const int lobe_lanes = Lanes<kOneVector>(reader.lobe_lanes());
  for (int c = 0; c < kChannels; ++c) {
    const double scale = at->w_residual[c] * reader.samples().inverse_cosines[at->j];
    // One lookup of D has those of all stretches.
    const auto load = [&](int lookup, int v, Lanes4* part) {
      const TableLanes& lanes = reader.lanes(job.order.factor(lookup));
      const double* const from = at->lookups[lookup].value + lanes.First(c);
      if (lanes.per_lobe) {
        LoadLanes(from + v, part);
      } else {
        *part = Lanes4{} + *from;
      }
    };
    for (int v = 0; v < lobe_lanes; v += kVector) {
      Lanes4 s, D, F, G_i, G_o;
      LoadLanes(reader.s() + c * lobe_lanes + v, &s);
      load(job.order.F() - 1, v, &D);
      load(job.order.F(), v, &F);
      load(job.order.G_i(), v, &G_i);
      load(job.order.G_o(), v, &G_o);
      const auto set = [&](Part a, Part b, const Lanes4& value) {
        StoreLanes(value, at->second[a][b][c] + v);
      };
      const Lanes4 scaled_s = scale * s, sD = scaled_s * D, sF = scaled_s * F;
      const Lanes4 DF = scale * D * F, G = scale * G_i * G_o;
      set(kS, kOfD, F * G);
      set(kS, kOfF, D * G);
      set(kS, kOfG_i, DF * G_o);
      set(kS, kOfG_o, DF * G_i);
      set(kOfD, kOfF, s * G);
      set(kOfD, kOfG_i, sF * G_o);
      set(kOfD, kOfG_o, sF * G_i);
      set(kOfF, kOfG_i, sD * G_o);
      set(kOfF, kOfG_o, sD * G_i);
      set(kOfG_i, kOfG_o, sD * F);
    }
  }
}

// d and s of each channel, which move nothing in another one.
TRILOBE_ALWAYS_INLINE void AddAmplitudes(const SumJob& job, const Sample& at, bool newton) {
  const AccumulatorRows& rows = job.layout->amplitudes();
  const FoldedSamples& samples = job.reader->samples();
  for (int c = 0; c < kChannels; ++c) {
    double* const own = job.sums + rows.own + c * rows.own_size();
    const double* const slope = at.amplitude + c * rows.lanes;
    const double w = samples.weight[c][at.j];
    AddScaled(rows.lanes, at.w_residual[c], slope, own + AccumulatorRows::kGradient * rows.lanes);
    double* const target = own + (AccumulatorRows::kFirstAmplitude + c * rows.tables) * rows.lanes;
    for (int a = 0; a < rows.tables; ++a) {
      AddScaled(rows.lanes, 0.5 * w * slope[a], slope, target + a * rows.lanes);
      if (newton) {
        own[AccumulatorRows::kSquaredLength * rows.lanes + a] += w * slope[a] * slope[a];
      }
    }
  }
}

// Sets what entries that lookup r reads have with amplitudes, with each other, and with those of
// all lookups before.
template <bool kOneVector, bool kNewton>
TRILOBE_ALWAYS_INLINE void SetProducts(const SumJob& job, const Sample& at, int r,
                                       ScatterBuffer* run) {
  const BatchEvaluator& reader = *job.reader;
  const ModelSpec& spec = reader.spec();
  const AccumulatorRows& rows = job.layout->of(r);
  const AccumulatorRows& amplitudes = job.layout->amplitudes();
  const int lanes = Lanes<kOneVector>(rows.lanes);
  const TableLanes& row_lanes = reader.lanes(job.order.factor(r));
  const Slopes& own = at.lookups[r];

  double* target = run->Lines(r);
  Combine<kOneVector>(at.residual, 1, own.w_slope, lanes, target);
  target += lanes;
  const int own_part = PartOf(job.order, r);
  for (int c = 0; c < kChannels; ++c) {
    double* of_lobe = target + row_lanes.First(c);
    for (int a = 0; a < amplitudes.tables; ++a, target += lanes) {
      Scale<kOneVector>(c, at.amplitude + a, amplitudes.lanes, own.w_slope, lanes, target);
    }
    if (!kNewton) continue;
    const double* const second = at.second[kS][own_part][c];
    for (int m = 0; m < spec.lobes; ++m, of_lobe += lanes + (row_lanes.per_lobe ? 1 : 0)) {
      *of_lobe += second[m];
    }
  }
  for (int q = 0; q <= r; ++q) {
    double* const products = run->Products(q, r);  // [tables][lanes]
    const Slopes& other = at.lookups[q];
    const Columns& columns = job.columns[q];
    const Factor factor = job.order.factor(q);
    const int of_lanes = Lanes<kOneVector>(reader.lanes(factor).size);
    target = products;
    if (spec.sharing(factor).per_channel) {
      for (const auto& [lane, channel] : columns.columns) {
        Scale<kOneVector>(channel, other.slope + lane, of_lanes, own.w_slope, lanes, target);
        target += lanes;
      }
    } else {
      for (const auto& [lane, channel] : columns.columns) {
        Combine<kOneVector>(other.slope + lane, of_lanes, own.w_slope, lanes, target);
        target += lanes;
      }
    }
    // Stretches of D are those of different lobes, whose lookups are not multiplied.
    if (kNewton && q != r && r >= job.order.F()) {
      const auto& second = at.second[PartOf(job.order, q)][own_part];
      const int* place = &columns.of_lobe[static_cast<size_t>(r) * kChannels * spec.lobes];
      if (spec.sharing(factor).per_channel || spec.sharing(job.order.factor(r)).per_channel) {
        for (const auto& of_channel : second) {
          for (int m = 0; m < spec.lobes; ++m, ++place) {
            if (*place >= 0) products[*place] += of_channel[m];
          }
        }
      } else {
        for (int m = 0; m < spec.lobes; ++m) {
          if (place[m] >= 0) products[place[m]] += second[0][m] + second[1][m] + second[2][m];
        }
      }
    }
  }
}

// y = sum_c slope_c w_slope_c of two lookups of one table, lane by lane.
TRILOBE_ALWAYS_INLINE void Multiply(const Slopes& a, const Slopes& b, int lanes, double* y) {
  static_assert(kChannels == 3);
  for (int k = 0; k < lanes; ++k) {
    y[k] = a.slope[k] * b.w_slope[k] + a.slope[lanes + k] * b.w_slope[lanes + k] +
           a.slope[2 * lanes + k] * b.w_slope[2 * lanes + k];
  }
}

// The squared lengths of entries that lookup r reads: that of an entry which both directions read
// has a product of the two.
template <bool kOneVector>
TRILOBE_ALWAYS_INLINE void AddSquaredLengths(const SumJob& job, const Sample& at, int r) {
  const AccumulatorRows& rows = job.layout->of(r);
  const int lanes = Lanes<kOneVector>(rows.lanes);
  const Slopes &own = at.lookups[r], &other = at.lookups[job.order.G_i()];
  double* const lengths =
      job.sums + rows.own + static_cast<ptrdiff_t>(AccumulatorRows::kSquaredLength) * lanes;
  alignas(sizeof(Lanes8)) double product[kMaxLanes];
  Multiply(own, own, lanes, product);
  for (int k = 0; k < own.cell->size; ++k) {
    AddScaled(lanes, own.weight[k] * own.weight[k], product,
              lengths + own.cell->entry[k] * rows.own_size());
  }
  if (r != job.order.G_o()) return;
  for (int k = 0; k < own.cell->size; ++k) {
    for (int l = 0; l < other.cell->size; ++l) {
      if (own.cell->entry[k] != other.cell->entry[l]) continue;
      Multiply(other, own, lanes, product);
      AddScaled(lanes, 2 * own.weight[k] * other.weight[l], product,
                lengths + own.cell->entry[k] * rows.own_size());
    }
  }
}

// Samples [begin, end), those of the batch.
template <bool kOneVector, bool kNewton>
TRILOBE_ALWAYS_INLINE double AddBatch(const SumJob& job, int begin, int end,
                                      const BatchEvaluator::Batch& batch, Sample* at,
                                      ScatterBuffer* run) {
  const BatchEvaluator& reader = *job.reader;
  const FoldedSamples& samples = reader.samples();
  const LookupOrder& order = job.order;
  const int G_lanes = Lanes<kOneVector>(reader.lanes(Factor::kG).size);
  double objective = 0;
  alignas(sizeof(Lanes8)) double G_slope[2][kChannels * kMaxLanes];
  for (int j = begin; j < end; ++j) {
    const int n = j - begin;
    run->Next();
    at->j = j;
    at->residual = batch.residual.data() + n * kChannels;
    at->amplitude = batch.amplitude.data() + n * kChannels * reader.amplitude_lanes();
    double w[kChannels];
    for (int c = 0; c < kChannels; ++c) {
      w[c] = samples.weight[c][j];
      at->w_residual[c] = w[c] * at->residual[c];
      objective += at->w_residual[c] * at->residual[c];
    }
    for (int r = 0; r < order.count(); ++r) {
      const FoldedSamples::Lookup& lookups = samples.lookups[r];
      const Factor factor = order.factor(r);
      const int lanes = Lanes<kOneVector>(reader.lanes(factor).size);
      Slopes& slopes = at->lookups[r];
      slopes.cell = &samples.cells_of(factor)[lookups.cell[j]];
      double* const weight = run->Read(r, lookups.cell[j], *slopes.cell);
      for (int k = 0; k < slopes.cell->size; ++k) weight[k] = lookups.weight[k][j];
      slopes.weight = weight;
      if (factor != Factor::kG) {
        const bool is_D = factor == Factor::kD;
        slopes.value = (is_D ? batch.D : batch.F).data() + n * lanes;
        slopes.slope = (is_D ? batch.D_slope : batch.F_slope).data() + n * kChannels * lanes;
      } else {
        // d rho / d G of one direction has G of the other.
        const bool is_i = r == order.G_i();
        const double* const other = (is_i ? batch.G_o : batch.G_i).data() + n * G_lanes;
        const double* const shadow = batch.shadow.data() + n * kChannels * G_lanes;
        double* const slope = G_slope[is_i ? 0 : 1];
        for (int c = 0; c < kChannels; ++c) {
          for (int b = 0; b < G_lanes; ++b) {
            slope[c * G_lanes + b] = shadow[c * G_lanes + b] * other[b];
          }
        }
        slopes.value = (is_i ? batch.G_i : batch.G_o).data() + n * G_lanes;
        slopes.slope = slope;
      }
      for (int c = 0; c < kChannels; ++c) {
        for (int b = 0; b < lanes; ++b) {
          slopes.w_slope[c * lanes + b] = w[c] * slopes.slope[c * lanes + b];
        }
      }
    }
    if (kNewton) SetSecondDerivatives<kOneVector>(job, at);
    AddAmplitudes(job, *at, kNewton);
    for (int r = 0; r < order.count(); ++r) {
      if (job.layout->of(r).tables == 0) continue;
      SetProducts<kOneVector, kNewton>(job, *at, r, run);
      if (kNewton) AddSquaredLengths<kOneVector>(job, *at, r);
    }
  }
  return objective;
}

using AddBatchFunction = double (*)(const SumJob&, int, int, const BatchEvaluator::Batch&, Sample*,
                                    ScatterBuffer*);
TRILOBE_MULTIVERSION
double AddGaussNewton(const SumJob& job, int begin, int end, const BatchEvaluator::Batch& batch,
                      Sample* at, ScatterBuffer* run) {
  return AddBatch<false, false>(job, begin, end, batch, at, run);
}
TRILOBE_MULTIVERSION
double AddGaussNewtonOfOneVector(const SumJob& job, int begin, int end,
                                 const BatchEvaluator::Batch& batch, Sample* at,
                                 ScatterBuffer* run) {
  return AddBatch<true, false>(job, begin, end, batch, at, run);
}
TRILOBE_MULTIVERSION
double AddNewton(const SumJob& job, int begin, int end, const BatchEvaluator::Batch& batch,
                 Sample* at, ScatterBuffer* run) {
  return AddBatch<false, true>(job, begin, end, batch, at, run);
}
TRILOBE_MULTIVERSION
double AddNewtonOfOneVector(const SumJob& job, int begin, int end,
                            const BatchEvaluator::Batch& batch, Sample* at, ScatterBuffer* run) {
  return AddBatch<true, true>(job, begin, end, batch, at, run);
}

}  // namespace

double AddNormalEquations(const BatchEvaluator& reader, const AccumulatorLayout& layout,
                          Hessian hessian, int begin, int end, double* sums) {
  SumJob job{};
  job.reader = &reader;
  job.layout = &layout;
  job.order = reader.samples().order;
  job.sums = &sums[0];
  for (int r = 0; r < job.order.count(); ++r) {
    const Factor factor = job.order.factor(r);
    const AccumulatorRows& rows = layout.of(r);
    Columns columns;
    std::vector<int> place(reader.spec().num_tables(factor), -1);
    for (int k = 0; k < rows.tables; ++k) {
      place[rows.table[k]] = k;
      columns.columns.push_back(
          {rows.lane[k], reader.spec().channels(factor, rows.table[k]).begin});
    }
    for (int later = 0; later < job.order.count(); ++later) {
      const TableLanes& lanes = reader.lanes(job.order.factor(later));
      for (int c = 0; c < kChannels; ++c) {
        for (int m = 0; m < reader.spec().lobes; ++m) {
          const int column = place[reader.spec().table(factor, m, c)];
          columns.of_lobe.push_back(column < 0 ? -1 : column * lanes.size + LaneOf(lanes, m, c));
        }
      }
    }
    job.columns.push_back(std::move(columns));
  }
  const bool newton = hessian == Hessian::kNewton;
  const AddBatchFunction add_batch = reader.one_vector()
                                         ? newton ? AddNewtonOfOneVector : AddGaussNewtonOfOneVector
                                     : newton ? AddNewton
                                              : AddGaussNewton;
  BatchEvaluator::Batch batch(reader);
  Sample at{};
  ScatterBuffer run(job.order, layout, sums);
  double objective = 0;
  while (begin < end) {
    const int batch_end = std::min(begin + BatchEvaluator::kBatch, end);
    reader.Read(begin, batch_end, BatchEvaluator::Slopes::kAll, &batch);
    objective += add_batch(job, begin, batch_end, batch, &at, &run);
    begin = batch_end;
  }
  run.Flush();
  return objective;
}

}  // namespace trilobe
