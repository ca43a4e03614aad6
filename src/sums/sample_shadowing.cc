#include "trilobe/sums/sample_shadowing.h"

#include <algorithm>
#include <array>

#include "trilobe/base/multiversion.h"
#include "trilobe/base/parallel.h"
#include "trilobe/math/element_step.h"

namespace trilobe {
namespace {

// Consecutive samples that read a node in the same way, and a place for their numbers.
struct SampleRange {
  int size;
  const double *A, *weight_i, *weight_o;
  double *b, *G_i, *G_o;
};

constexpr int kLanes = 8;

template <bool kBoth>
TRILOBE_ALWAYS_INLINE void AddLanes(const SampleRange& at, int n, const double* G,
                                    const double* weight, Lanes8* c) {
  Lanes8 A, b, w, g;
  LoadLanes(at.A + n, &A);
  LoadLanes(at.b + n, &b);
  LoadLanes(weight + n, &w);
  LoadLanes(G + n, &g);
  if constexpr (kBoth) {
    Lanes8 w_o, G_i;
    LoadLanes(at.weight_o + n, &w_o);
    LoadLanes(at.G_i + n, &G_i);
    const Lanes8 p1 = w * g + w_o * G_i, p2 = w * w_o, A_p2 = A * p2;
    c[0] -= 2 * b * p1;
    c[1] += A * p1 * p1 - 2 * b * p2;
    c[2] += 2 * A_p2 * p1;
    c[3] += A_p2 * p2;
  } else {
    const Lanes8 p1 = w * g;
    c[0] -= 2 * b * p1;
    c[1] += A * p1 * p1;
  }
}

// c1 .. c4 of the change of E (ElementQuartic).
template <bool kBoth>
TRILOBE_ALWAYS_INLINE void AddStretch(const SampleRange& at, double* c) {
  // Of one direction alone, G of the other one counts.
  const bool is_i = at.weight_i != nullptr;
  const double* const weight = is_i ? at.weight_i : at.weight_o;
  const double* const G = is_i ? at.G_o : at.G_i;
  constexpr int kTerms = kBoth ? 4 : 2;
  const int whole = at.size - at.size % kLanes;
  if (whole > 0) {
    Lanes8 sums[4] = {};
    for (int n = 0; n < whole; n += kLanes) AddLanes<kBoth>(at, n, G, weight, sums);
    for (int k = 0; k < kTerms; ++k) {
      for (int lane = 0; lane < kLanes; ++lane) c[k] += sums[k][lane];
    }
  }
  for (int n = whole; n < at.size; ++n) {
    const double A = at.A[n], b = at.b[n];
    double p1 = weight[n] * G[n], p2 = 0;
    if (kBoth) {
      p1 += at.weight_o[n] * at.G_i[n];
      p2 = weight[n] * at.weight_o[n];
    }
    c[0] -= 2 * b * p1;
    c[1] += A * p1 * p1 - 2 * b * p2;
    if (kBoth) {
      c[2] += 2 * A * p1 * p2;
      c[3] += A * p2 * p2;
    }
  }
}

TRILOBE_MULTIVERSION
void AddChange(const SampleRange& at, double* c) {
  if (at.weight_i != nullptr && at.weight_o != nullptr) {
    AddStretch<true>(at, c);
  } else {
    AddStretch<false>(at, c);
  }
}

// A += w a^2, b += w a residual.
TRILOBE_MULTIVERSION
void AddToSums(int size, const double* __restrict w, const double* __restrict a,
               const double* __restrict residual, double* __restrict A, double* __restrict b) {
  for (int n = 0; n < size; ++n) {
    const double w_a = w[n] * a[n];
    A[n] += w_a * a[n];
    b[n] += w_a * residual[n];
  }
}

TRILOBE_MULTIVERSION
void SubtractChange(int size, const double* __restrict a, const double* __restrict G_i,
                    const double* __restrict G_o, const double* __restrict old_G_i,
                    const double* __restrict old_G_o, double* __restrict residual) {
  for (int n = 0; n < size; ++n) {
    residual[n] -= a[n] * (G_i[n] * G_o[n] - old_G_i[n] * old_G_o[n]);
  }
}

// The node moves.
TRILOBE_MULTIVERSION
void Move(const SampleRange& at, double step) {
  const double* __restrict const A = at.A;
  double* __restrict const b = at.b, * __restrict const G_i = at.G_i, * __restrict const G_o = at.G_o;
  const double* __restrict const weight_i = at.weight_i, * __restrict const weight_o = at.weight_o;
  if (weight_o == nullptr) {
    for (int n = 0; n < at.size; ++n) {
      const double change = step * weight_i[n];
      b[n] -= A[n] * (change * G_o[n]);
      G_i[n] += change;
    }
  } else if (weight_i == nullptr) {
    for (int n = 0; n < at.size; ++n) {
      const double change = step * weight_o[n];
      b[n] -= A[n] * (change * G_i[n]);
      G_o[n] += change;
    }
  } else {
    for (int n = 0; n < at.size; ++n) {
      const double change_i = step * weight_i[n], change_o = step * weight_o[n];
      b[n] -= A[n] * (change_i * G_o[n] + change_o * G_i[n] + change_i * change_o);
      G_i[n] += change_i;
      G_o[n] += change_o;
    }
  }
}

}  // namespace

SampleShadowing::SampleShadowing(const FoldedSamples& samples, const ModelSpec& spec,
                                 int num_threads)
    : samples_(samples),
      num_threads_(num_threads),
      reader_(samples, spec),
      readers_(spec.table_size(Factor::kG)),
      A_(samples.size()),
      b_(samples.size()) {
  const size_t size = samples.size();
  for (std::vector<double>& of_channel : residual_) of_channel.resize(size);
  for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
    const auto [begin, end] = spec.channels(Factor::kG, t);
    tables_.push_back({std::vector<double>(size), std::vector<double>(size),
                       std::vector<std::vector<double>>(end - begin, std::vector<double>(size))});
  }
  const std::vector<Cell>& cells = samples.cells_of(Factor::kG);
  for (const auto& [cell_i, cell_o, begin, end] : samples.pairs) {
    const Cell &i = cells[cell_i], &o = cells[cell_o];
    const auto place = [](const Cell& cell, int entry) {
      const auto last = cell.entry.begin() + cell.size;
      const auto found = std::find(cell.entry.begin(), last, entry);
      return found == last ? -1 : static_cast<int>(found - cell.entry.begin());
    };
    for (int k = 0; k < i.size; ++k) {
      readers_[i.entry[k]].push_back({begin, end, k, place(o, i.entry[k])});
    }
    for (int k = 0; k < o.size; ++k) {
      if (place(i, o.entry[k]) < 0) readers_[o.entry[k]].push_back({begin, end, -1, k});
    }
  }
}

void SampleShadowing::ForChunks(const std::function<void(int, int)>& work) const {
  constexpr int kChunk = 64 * SampleReader::kBatch;
  ParallelFor((samples_.size() + kChunk - 1) / kChunk, num_threads_,
              [&](int k) { work(k * kChunk, std::min((k + 1) * kChunk, samples_.size())); });
}

void SampleShadowing::Read(const FactorModel& model) {
  reader_.SetModel(model);
  const TableLanes& lanes = reader_.lanes(Factor::kG);
  ForChunks([&](int chunk_begin, int chunk_end) {
    SampleReader::Batch batch(reader_);
    for (int begin = chunk_begin; begin < chunk_end; begin += SampleReader::kBatch) {
      const int end = std::min(begin + SampleReader::kBatch, chunk_end);
      reader_.Read(begin, end, {.G = true}, &batch);
      const auto copy = [&](const double* from, int stride, std::vector<double>* to) {
        for (int j = begin; j < end; ++j) (*to)[j] = from[(j - begin) * stride];
      };
      for (int c = 0; c < kChannels; ++c) {
        for (int j = begin; j < end; ++j) {
          residual_[c][j] = -batch.residual[(j - begin) * kChannels + c];
        }
      }
      for (size_t t = 0; t < tables_.size(); ++t) {
        const int lane = lanes.of_table[t];
        OfTable& of = tables_[t];
        copy(&batch.G_i[lane], lanes.size, &of.G_i);
        copy(&batch.G_o[lane], lanes.size, &of.G_o);
        const int first = reader_.spec().channels(Factor::kG, static_cast<int>(t)).begin;
        for (size_t c = 0; c < of.a.size(); ++c) {
          copy(&batch.shadow[(first + c) * lanes.size + lane], kChannels * lanes.size, &of.a[c]);
        }
      }
    }
  });
}

void SampleShadowing::SetSums(int t) {
  const OfTable& of = tables_[t];
  const int first = reader_.spec().channels(Factor::kG, t).begin;
  ForChunks([&](int begin, int end) {
    std::fill(A_.begin() + begin, A_.begin() + end, 0.0);
    std::fill(b_.begin() + begin, b_.begin() + end, 0.0);
    for (size_t c = 0; c < of.a.size(); ++c) {
      AddToSums(end - begin, &samples_.weight[first + c][begin], &of.a[c][begin],
                &residual_[first + c][begin], &A_[begin], &b_[begin]);
    }
  });
}

void SampleShadowing::UpdateTable(int t, const std::function<void(const FactorModel&)>& on_element,
                                  FactorModel* model) {
  OfTable& of_table = tables_[t];
  const auto stretch = [&](const Readers& of) {
    const auto weight = [&](int reading, int k) {
      return k < 0 ? nullptr : samples_.readings[reading].weight[k].data() + of.begin;
    };
    return SampleRange{.size = of.end - of.begin,
                       .A = &A_[of.begin],
                       .weight_i = weight(samples_.order.G_i(), of.i),
                       .weight_o = weight(samples_.order.G_o(), of.o),
                       .b = &b_[of.begin],
                       .G_i = &of_table.G_i[of.begin],
                       .G_o = &of_table.G_o[of.begin]};
  };
  SetSums(t);
  const std::vector<double> old_G_i = of_table.G_i, old_G_o = of_table.G_o;
  const std::span<double> table = model->table(Factor::kG, t);
  for (size_t node = 0; node < table.size(); ++node) {
    std::array<double, 4> c{};
    for (const Readers& of : readers_[node]) AddChange(stretch(of), c.data());
    const double step =
        BestElement(table[node], {.c1 = c[0], .c2 = c[1], .c3 = c[2], .c4 = c[3]}) - table[node];
    if (step != 0) {
      for (const Readers& of : readers_[node]) Move(stretch(of), step);
      table[node] += step;
    }
    if (on_element) on_element(*model);
  }
  const int first = reader_.spec().channels(Factor::kG, t).begin;
  ForChunks([&](int begin, int end) {
    for (size_t c = 0; c < of_table.a.size(); ++c) {
      SubtractChange(end - begin, &of_table.a[c][begin], &of_table.G_i[begin], &of_table.G_o[begin],
                     &old_G_i[begin], &old_G_o[begin], &residual_[first + c][begin]);
    }
  });
}

}  // namespace trilobe
