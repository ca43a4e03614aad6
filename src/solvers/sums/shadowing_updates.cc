#include "solvers/sums/shadowing_updates.h"

#include <algorithm>
#include <array>
#include <functional>
#include <span>

#include "core/algebra/element_step.h"
#include "core/base/multiversion.h"

namespace trilobe {
namespace {

// Consecutive samples that read a node in the same way, and a place for their numbers.
struct SampleRange {
  int size;
  const double *A, *weight_i, *weight_o;
  double *b, *G_i, *G_o;
};

// The numbers of all samples.
struct NodeJob {
  const double* A;
  double *b, *G_i, *G_o;
  // Weights of the entries of cells of G, for either direction.
  std::array<const double*, Stencil::kMaxSize> weight_i, weight_o;

  SampleRange Of(const ShadowingUpdates::Readers& readers) const {
    return {.size = readers.end - readers.begin,
            .A = A + readers.begin,
            .weight_i = readers.i < 0 ? nullptr : weight_i[readers.i] + readers.begin,
            .weight_o = readers.o < 0 ? nullptr : weight_o[readers.o] + readers.begin,
            .b = b + readers.begin,
            .G_i = G_i + readers.begin,
            .G_o = G_o + readers.begin};
  }
};

constexpr int kLanes = 8;

template <bool kBoth, typename Eight>
TRILOBE_ALWAYS_INLINE void AddLanes(const SampleRange& at, int n, const double* G,
                                    const double* weight, Eight* c) {
  Eight A, b, w, g;
  LoadLanes(at.A + n, &A);
  LoadLanes(at.b + n, &b);
  LoadLanes(weight + n, &w);
  LoadLanes(G + n, &g);
  if constexpr (kBoth) {
    Eight w_o, G_i;
    LoadLanes(at.weight_o + n, &w_o);
    LoadLanes(at.G_i + n, &G_i);
    const Eight p1 = w * g + w_o * G_i, p2 = w * w_o, A_p2 = A * p2;
    c[0] -= 2 * b * p1;
    c[1] += A * p1 * p1 - 2 * b * p2;
    c[2] += 2 * A_p2 * p1;
    c[3] += A_p2 * p2;
  } else {
    const Eight p1 = w * g;
    c[0] -= 2 * b * p1;
    c[1] += A * p1 * p1;
  }
}

// c1 .. c4 of the change of E (ElementQuartic).
template <bool kBoth, typename Eight>
TRILOBE_ALWAYS_INLINE void AddStretch(const SampleRange& at, double* c) {
  // If only one direction reads the node, G of the other one is a factor.
  const bool is_i = at.weight_i != nullptr;
  const double* const weight = is_i ? at.weight_i : at.weight_o;
  const double* const G = is_i ? at.G_o : at.G_i;
  constexpr int kTerms = kBoth ? 4 : 2;
  const int whole = at.size - at.size % kLanes;
  if (whole > 0) {
    Eight sums[4] = {};
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

template <typename Eight>
TRILOBE_ALWAYS_INLINE void AddChangeBy(const NodeJob& job,
                                       std::span<const ShadowingUpdates::Readers> readers,
                                       double* c) {
  for (const ShadowingUpdates::Readers& range : readers) {
    if (range.i >= 0 && range.o >= 0) {
      AddStretch<true, Eight>(job.Of(range), c);
    } else {
      AddStretch<false, Eight>(job.Of(range), c);
    }
  }
}
void AddChange(const NodeJob& job, std::span<const ShadowingUpdates::Readers> readers, double* c) {
  TRILOBE_FOR_EIGHT(AddChangeBy, job, readers, c);
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

// The node that these samples read moves.
TRILOBE_ALWAYS_INLINE void MoveRange(const SampleRange& at, double step) {
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

TRILOBE_MULTIVERSION
void Move(const NodeJob& job, std::span<const ShadowingUpdates::Readers> readers, double step) {
  for (const ShadowingUpdates::Readers& range : readers) MoveRange(job.Of(range), step);
}

}  // namespace

ShadowingUpdates::ShadowingUpdates(const SampleLookups& lookups)
    : lookups_(lookups),
      readers_(lookups.spec().table_size(Factor::kG)),
      A_(lookups.samples().size()),
      b_(lookups.samples().size()) {
  const FoldedSamples& samples = lookups_.samples();
  for (std::vector<double>& of_channel : residual_) of_channel.resize(samples.size());
  const auto add = [&](int node, const Readers& range) {
    std::vector<Readers>& all = readers_[node];
    if (!all.empty() && all.back().end == range.begin && all.back().i == range.i &&
        all.back().o == range.o) {
      all.back().end = range.end;
    } else {
      all.push_back(range);
    }
  };
  const std::vector<Cell>& cells = samples.cells_of(Factor::kG);
  for (const auto& [cell_i, cell_o, begin, end] : samples.pairs) {
    const Cell &i = cells[cell_i], &o = cells[cell_o];
    const auto place = [](const Cell& cell, int entry) {
      const auto last = cell.entry.begin() + cell.size;
      const auto found = std::find(cell.entry.begin(), last, entry);
      return found == last ? -1 : static_cast<int>(found - cell.entry.begin());
    };
    for (int k = 0; k < i.size; ++k) add(i.entry[k], {begin, end, k, place(o, i.entry[k])});
    for (int k = 0; k < o.size; ++k) {
      if (place(i, o.entry[k]) < 0) add(o.entry[k], {begin, end, -1, k});
    }
  }
}

void ShadowingUpdates::Read(const FactorModel& model) {
  constexpr int kBatch = SampleLookups::kBatch;
  lookups_.ForChunks([&](int chunk_begin, int chunk_end) {
    SampleLookups::Batch batch(lookups_.spec(), ParameterKind::kG);
    for (int begin = chunk_begin; begin < chunk_end; begin += kBatch) {
      const int size = std::min(kBatch, chunk_end - begin);
      lookups_.Evaluate(begin, begin + size, model, &batch);
      for (int c = 0; c < kChannels; ++c) {
        std::transform(&batch.residual[c * kBatch], &batch.residual[c * kBatch] + size,
                       &residual_[c][begin], std::negate<>());
      }
    }
  });
}

void ShadowingUpdates::ForSlopes(
    int t, const FactorModel& model,
    const std::function<void(int begin, int end, const SampleLookups::Batch&)>& use) const {
  constexpr int kBatch = SampleLookups::kBatch;
  lookups_.ForChunks([&](int chunk_begin, int chunk_end) {
    SampleLookups::Batch batch(lookups_.spec(), ParameterKind::kG);
    for (int begin = chunk_begin; begin < chunk_end; begin += kBatch) {
      const int end = std::min(begin + kBatch, chunk_end);
      lookups_.SlopesInG(t, begin, end, model, &batch);
      use(begin, end, batch);
    }
  });
}

void ShadowingUpdates::SetSums(int t, const FactorModel& model) {
  const auto channels = lookups_.spec().channels(Factor::kG, t);
  ForSlopes(t, model, [&](int begin, int end, const SampleLookups::Batch& batch) {
    std::fill(A_.begin() + begin, A_.begin() + end, 0.0);
    std::fill(b_.begin() + begin, b_.begin() + end, 0.0);
    for (int c = channels.begin; c < channels.end; ++c) {
      AddToSums(end - begin, &lookups_.samples().weight[c][begin], batch.Slope(c, t),
                &residual_[c][begin], &A_[begin], &b_[begin]);
    }
  });
}

void ShadowingUpdates::UpdateTable(int t, const std::function<void(const FactorModel&)>& on_element,
                                   FactorModel* model) {
  const FoldedSamples& samples = lookups_.samples();
  lookups_.ReadG(t, &G_i_, &G_o_);
  NodeJob job{.A = A_.data(),
              .b = b_.data(),
              .G_i = G_i_.data(),
              .G_o = G_o_.data(),
              .weight_i = {},
              .weight_o = {}};
  const auto weights = [&](int lookup, std::array<const double*, Stencil::kMaxSize>* pointers) {
    const std::vector<std::vector<double>>& weight = samples.lookups[lookup].weight;
    for (size_t k = 0; k < weight.size(); ++k) (*pointers)[k] = weight[k].data();
  };
  weights(samples.order.G_i(), &job.weight_i);
  weights(samples.order.G_o(), &job.weight_o);
  SetSums(t, *model);
  old_G_i_ = G_i_;
  old_G_o_ = G_o_;
  const std::span<double> table = model->table(Factor::kG, t);
  for (size_t node = 0; node < table.size(); ++node) {
    std::array<double, 4> c{};
    AddChange(job, readers_[node], c.data());
    const double step =
        BestElement(table[node], {.c1 = c[0], .c2 = c[1], .c3 = c[2], .c4 = c[3]}) - table[node];
    if (step != 0) {
      Move(job, readers_[node], step);
      table[node] += step;
    }
    if (on_element) on_element(*model);
  }
  const auto channels = lookups_.spec().channels(Factor::kG, t);
  ForSlopes(t, *model, [&](int begin, int end, const SampleLookups::Batch& batch) {
    for (int c = channels.begin; c < channels.end; ++c) {
      SubtractChange(end - begin, batch.Slope(c, t), &G_i_[begin], &G_o_[begin], &old_G_i_[begin],
                     &old_G_o_[begin], &residual_[c][begin]);
    }
  });
}

}  // namespace trilobe
