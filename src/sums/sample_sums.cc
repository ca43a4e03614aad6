#include "trilobe/sums/sample_sums.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "trilobe/base/multiversion.h"

namespace trilobe {
namespace {

constexpr int kMaxLanes = kChannels * PaddedToVectors(kMaxLobes);
constexpr int kMaxOwnLines = SampleRows::kFirstAmplitude + kChannels * (1 + kMaxLobes);
constexpr int kMaxTables = kChannels * kMaxLobes;

// The tables that a reading reads, as columns of products: in what order, the lane of each, and the
// first channel that it serves.
struct Columns {
  struct Column {
    int lane, channel;
  };
  std::vector<Column> of;
  std::vector<int> place;  // by the number of the table; -1 where another stretch reads it
};

// What is the same for all samples.
struct SumJob {
  const SampleReader* reader;
  const SampleLayout* layout;
  ReadingOrder order;
  std::vector<Columns> columns;  // [order.count()]
  double* sums;
};

// One reading of a sample: how its value moves with it in each channel, and the same times w.
struct Slopes {
  const Cell* cell;
  int cell_number;
  double weight[Stencil::kMaxSize];                               // of the stencil
  const double* reading;                                          // [lanes]
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

// Adds the same numbers, times a weight, to the blocks of a cell's entries.
template <int kEntries>
TRILOBE_ALWAYS_INLINE void AddToBlocks(const double* from, int size, double scale,
                                       const double* weight, const int* entry, ptrdiff_t stride,
                                       double* blocks) {
  std::array<Lanes4, kEntries> weights;
  std::array<ptrdiff_t, kEntries> begin;
  for (int k = 0; k < kEntries; ++k) {
    weights[k] = Lanes4{} + scale * weight[k];
    begin[k] = entry[k] * stride;
  }
  for (int i = 0; i < size; i += kVector) {
    Lanes4 x;
    LoadLanes(from + i, &x);
    for (int k = 0; k < kEntries; ++k) {
      Lanes4 y;
      LoadLanes(blocks + begin[k] + i, &y);
      StoreLanes(y + weights[k] * x, blocks + begin[k] + i);
    }
  }
}

// To those of the entries that a reading reads.
TRILOBE_ALWAYS_INLINE void AddToEntries(const double* from, int size, double scale,
                                        const Slopes& to, const int* entry, ptrdiff_t stride,
                                        double* blocks) {
  switch (to.cell->size) {
    case 4:
      AddToBlocks<4>(from, size, scale, to.weight, entry, stride, blocks);
      break;
    case 3:
      AddToBlocks<1>(from, size, scale, to.weight + 2, entry + 2, stride, blocks);
      [[fallthrough]];
    case 2:
      AddToBlocks<2>(from, size, scale, to.weight, entry, stride, blocks);
      break;
    default:
      AddToBlocks<1>(from, size, scale, to.weight, entry, stride, blocks);
  }
}

// What multiplies in a lobe: s and the readings of D, F, G_i and G_o, in their order.
constexpr int kS = 0, kParts = 5;
TRILOBE_ALWAYS_INLINE int PartOf(const ReadingOrder& order, int reading) {
  return reading < order.F() ? 1 : 2 + reading - order.F();
}

struct Sample {
  int j;
  const double* residual;  // [kChannels]
  double w_residual[kChannels];
  const double* amplitude;  // [kChannels][amplitude lanes]
  Slopes of[ReadingOrder::kMost];
  // Of the lobes, for second derivatives alone.
  alignas(sizeof(Lanes8)) double part[kParts][kChannels][PaddedToVectors(kMaxLobes)];
};

// Sets what second derivatives ask for.
template <bool kOneVector>
TRILOBE_ALWAYS_INLINE void SetParts(const SumJob& job, Sample* at) {
  const SampleReader& reader = *job.reader;
  const int lobe_lanes = Lanes<kOneVector>(reader.lobe_lanes());
  for (int c = 0; c < kChannels; ++c) {
    for (int b = 0; b < lobe_lanes; ++b) at->part[kS][c][b] = reader.s()[c * lobe_lanes + b];
    // One reading of D has those of all stretches.
    for (int r = job.order.F() - 1; r < job.order.count(); ++r) {
      const TableLanes& lanes = reader.lanes(job.order.factor(r));
      const double* const reading = at->of[r].reading + lanes.First(c);
      double* const to = at->part[PartOf(job.order, r)][c];
      for (int b = 0; b < lobe_lanes; ++b) to[b] = reading[lanes.per_lobe ? b : 0];
    }
  }
}

// w (rho - rho*) d2 rho / (d a d b) of the lobes in a channel, for two of their parts: what is left
// of s D F G_i G_o / (cos cos) without these.
template <bool kOneVector>
TRILOBE_ALWAYS_INLINE void SecondDerivatives(const SumJob& job, const Sample& at, int a, int b,
                                             int c, double* of_lobes) {
  const SampleReader& reader = *job.reader;
  const int lobe_lanes = Lanes<kOneVector>(reader.lobe_lanes());
  const double scale = at.w_residual[c] * reader.samples().inverse_cosines[at.j];
  for (int v = 0; v < lobe_lanes; v += kVector) {
    Lanes4 product = Lanes4{} + scale;
    for (int p = 0; p < kParts; ++p) {
      if (p == a || p == b) continue;
      Lanes4 part;
      LoadLanes(at.part[p][c] + v, &part);
      product *= part;
    }
    StoreLanes(product, of_lobes + v);
  }
}

// d and s of each channel, which move nothing in another one.
TRILOBE_ALWAYS_INLINE void AddAmplitudes(const SumJob& job, const Sample& at, bool newton) {
  const SampleRows& rows = job.layout->amplitudes();
  const FoldedSamples& samples = job.reader->samples();
  for (int c = 0; c < kChannels; ++c) {
    double* const own = job.sums + rows.own + c * rows.own_size();
    const double* const slope = at.amplitude + c * rows.lanes;
    const double w = samples.weight[c][at.j];
    AddScaled(rows.lanes, at.w_residual[c], slope, own + SampleRows::kGradient * rows.lanes);
    double* const to = own + (SampleRows::kFirstAmplitude + c * rows.tables) * rows.lanes;
    for (int a = 0; a < rows.tables; ++a) {
      AddScaled(rows.lanes, 0.5 * w * slope[a], slope, to + a * rows.lanes);
      if (newton) {
        own[SampleRows::kSquaredLength * rows.lanes + a] += w * slope[a] * slope[a];
      }
    }
  }
}

// The table entries of reading r, with themselves and all that come before.
template <bool kOneVector, bool kNewton>
TRILOBE_ALWAYS_INLINE void AddReading(const SumJob& job, int r, Sample* at) {
  const SampleReader& reader = *job.reader;
  const ModelSpec& spec = reader.spec();
  const SampleRows& rows = job.layout->of(r);
  const SampleRows& amplitudes = job.layout->amplitudes();
  const int lanes = Lanes<kOneVector>(rows.lanes);
  const TableLanes& row_lanes = reader.lanes(job.order.factor(r));
  const Slopes& own = at->of[r];
  const int first_own = std::min(r, job.order.G_i());  // reading of the same table
  alignas(sizeof(Lanes8)) double second[PaddedToVectors(kMaxLobes)] = {};  // derivatives

  alignas(sizeof(Lanes8)) double lines[kMaxOwnLines * kMaxLanes];
  double* to = lines;
  if (kNewton) {
    for (int b = 0; b < lanes; ++b) to[b] = 0;  // the squared length: below
    to += lanes;
  }
  Combine<kOneVector>(at->residual, 1, own.w_slope, lanes, to);
  to += lanes;
  const int own_part = PartOf(job.order, r);
  for (int c = 0; c < kChannels; ++c) {
    if (kNewton) SecondDerivatives<kOneVector>(job, *at, kS, own_part, c, second);
    for (int a = 0; a < amplitudes.tables; ++a, to += lanes) {
      Scale<kOneVector>(c, at->amplitude + a, amplitudes.lanes, own.w_slope, lanes, to);
      if (kNewton && a < spec.lobes) to[LaneOf(row_lanes, a, c)] += second[a];
    }
  }
  double* const of_entry = job.sums + rows.own + (kNewton ? 0 : SampleRows::kGradient * lanes);
  const auto own_size = static_cast<ptrdiff_t>(rows.own_size());
  const int* const entry = own.cell->entry.data();
  AddToEntries(lines, static_cast<int>(to - lines), 1, own, entry, own_size, of_entry);

  alignas(sizeof(Lanes8)) double products[kMaxTables * kMaxLanes];  // [tables][lanes]
  for (int q = 0; q <= r; ++q) {
    const Slopes& of = at->of[q];
    const Columns& columns = job.columns[q];
    const Factor factor = job.order.factor(q);
    const int of_lanes = Lanes<kOneVector>(reader.lanes(factor).size);
    to = products;
    if (spec.sharing(factor).per_channel) {
      for (const auto& [lane, channel] : columns.of) {
        Scale<kOneVector>(channel, of.slope + lane, of_lanes, own.w_slope, lanes, to);
        to += lanes;
      }
    } else {
      for (const auto& [lane, channel] : columns.of) {
        Combine<kOneVector>(of.slope + lane, of_lanes, own.w_slope, lanes, to);
        to += lanes;
      }
    }
    // Stretches of D are those of different lobes, whose readings are not multiplied.
    if (kNewton && q != r && r >= job.order.F()) {
      for (int c = 0; c < kChannels; ++c) {
        SecondDerivatives<kOneVector>(job, *at, PartOf(job.order, q), own_part, c, second);
        for (int m = 0; m < spec.lobes; ++m) {
          const int place = columns.place[spec.table(factor, m, c)];
          if (place >= 0) products[place * lanes + LaneOf(row_lanes, m, c)] += second[m];
        }
      }
    }
    const int size = static_cast<int>(to - products);
    double* const blocks = job.sums + rows.blocks[job.layout->RowsOf(q)];
    const bool by_cell = q == r && rows.by_cell;
    constexpr int kInCell[] = {0, 1, 2, 3};
    static_assert(std::size(kInCell) == Stencil::kMaxSize);
    for (int l = 0; l < of.cell->size; ++l) {
      AddToEntries(
          products, size, q == r ? 0.5 * of.weight[l] : of.weight[l], own,
          by_cell ? kInCell : entry, size,
          blocks + (by_cell ? rows.InCell(own.cell_number, l)
                            : static_cast<size_t>(of.cell->entry[l]) * rows.entries * size));
    }
  }
  if (!kNewton) return;
  // The squared length of an entry that both directions read has a product of the two.
  for (int q = first_own; q <= r; ++q) {
    const Slopes& of = at->of[q];
    for (int b = 0; b < lanes; ++b) {
      double sum = 0;
      for (int c = 0; c < kChannels; ++c) {
        sum += of.slope[c * lanes + b] * own.w_slope[c * lanes + b];
      }
      products[b] = sum;
    }
    for (int k = 0; k < own.cell->size; ++k) {
      for (int l = 0; l < of.cell->size; ++l) {
        if (q == r ? k != l : own.cell->entry[k] != of.cell->entry[l]) continue;
        AddScaled(lanes, (q == r ? 1 : 2) * own.weight[k] * of.weight[l], products,
                  of_entry + own.cell->entry[k] * own_size);
      }
    }
  }
}

// Samples [begin, end) of a batch that begins at `first`.
template <bool kOneVector, bool kNewton>
TRILOBE_ALWAYS_INLINE double AddBatch(const SumJob& job, int begin, int end,
                                      const SampleReader::Batch& batch, Sample* at) {
  const SampleReader& reader = *job.reader;
  const FoldedSamples& samples = reader.samples();
  const ReadingOrder& order = job.order;
  const int G_lanes = Lanes<kOneVector>(reader.lanes(Factor::kG).size);
  double objective = 0;
  alignas(sizeof(Lanes8)) double G_slope[2][kChannels * kMaxLanes];
  for (int j = begin; j < end; ++j) {
    const int n = j - begin;
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
      const FoldedSamples::OfReading& readings = samples.readings[r];
      const Factor factor = order.factor(r);
      const int lanes = Lanes<kOneVector>(reader.lanes(factor).size);
      Slopes& of = at->of[r];
      of.cell_number = readings.cell[j];
      of.cell = &samples.cells_of(factor)[of.cell_number];
      for (int k = 0; k < of.cell->size; ++k) of.weight[k] = readings.weight[k][j];
      if (factor != Factor::kG) {
        const bool is_D = factor == Factor::kD;
        of.reading = (is_D ? batch.D : batch.F).data() + n * lanes;
        of.slope = (is_D ? batch.D_slope : batch.F_slope).data() + n * kChannels * lanes;
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
        of.reading = (is_i ? batch.G_i : batch.G_o).data() + n * G_lanes;
        of.slope = slope;
      }
      for (int c = 0; c < kChannels; ++c) {
        for (int b = 0; b < lanes; ++b) of.w_slope[c * lanes + b] = w[c] * of.slope[c * lanes + b];
      }
    }
    if (kNewton) SetParts<kOneVector>(job, at);
    AddAmplitudes(job, *at, kNewton);
    for (int r = 0; r < order.count(); ++r) {
      if (job.layout->of(r).tables > 0) AddReading<kOneVector, kNewton>(job, r, at);
    }
  }
  return objective;
}

using AddBatchFunction = double (*)(const SumJob&, int, int, const SampleReader::Batch&, Sample*);
TRILOBE_MULTIVERSION
double AddGaussNewton(const SumJob& job, int begin, int end, const SampleReader::Batch& batch,
                      Sample* at) {
  return AddBatch<false, false>(job, begin, end, batch, at);
}
TRILOBE_MULTIVERSION
double AddGaussNewtonOfOneVector(const SumJob& job, int begin, int end,
                                 const SampleReader::Batch& batch, Sample* at) {
  return AddBatch<true, false>(job, begin, end, batch, at);
}
TRILOBE_MULTIVERSION
double AddNewton(const SumJob& job, int begin, int end, const SampleReader::Batch& batch,
                 Sample* at) {
  return AddBatch<false, true>(job, begin, end, batch, at);
}
TRILOBE_MULTIVERSION
double AddNewtonOfOneVector(const SumJob& job, int begin, int end, const SampleReader::Batch& batch,
                            Sample* at) {
  return AddBatch<true, true>(job, begin, end, batch, at);
}

}  // namespace

double AddSampleSums(const SampleReader& reader, const SampleLayout& layout, Hessian hessian,
                     int begin, int end, double* sums) {
  SumJob job{};
  job.reader = &reader;
  job.layout = &layout;
  job.order = reader.samples().order;
  job.sums = &sums[0];
  bool one_vector = true;
  for (int r = 0; r < job.order.count(); ++r) {
    const Factor factor = job.order.factor(r);
    one_vector = one_vector && reader.lanes(factor).size == kVector;
    const SampleRows& rows = layout.of(r);
    Columns columns{{}, std::vector<int>(reader.spec().num_tables(factor), -1)};
    for (int k = 0; k < rows.tables; ++k) {
      columns.place[rows.table[k]] = k;
      columns.of.push_back({rows.lane[k], reader.spec().channels(factor, rows.table[k]).begin});
    }
    job.columns.push_back(std::move(columns));
  }
  const bool newton = hessian == Hessian::kNewton;
  const AddBatchFunction add_batch = one_vector
                                         ? newton ? AddNewtonOfOneVector : AddGaussNewtonOfOneVector
                                     : newton ? AddNewton
                                              : AddGaussNewton;
  SampleReader::Batch batch(reader);
  Sample at{};
  double objective = 0;
  while (begin < end) {
    const int batch_end = std::min(begin + SampleReader::kBatch, end);
    reader.Read(begin, batch_end, SampleReader::Slopes::kAll, &batch);
    objective += add_batch(job, begin, batch_end, batch, &at);
    begin = batch_end;
  }
  return objective;
}

}  // namespace trilobe
