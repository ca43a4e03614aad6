#include "solvers/sums/accumulators.h"

#include <cstddef>

#include "core/base/multiversion.h"
#include "model/objective/batch_evaluator.h"

namespace trilobe {
namespace {

// Numbers of samples, to be added to several places, each by weights of its own.
struct Addition {
  int samples, size;
  const double* from;     // [samples][size]
  const double* weights;  // [samples][Stencil::kMaxSize]
  std::array<double*, Stencil::kMaxSize> target;
};

// Vectors of these numbers, from the i-th number on. The sums stay in registers.
static_assert(Stencil::kMaxSize == kVector);
template <int kEntries, int kVectors>
TRILOBE_ALWAYS_INLINE void AddVectors(const Addition& add, int i) {
  std::array<std::array<Lanes4, kVectors>, kEntries> sums;
  for (int k = 0; k < kEntries; ++k) {
    for (int v = 0; v < kVectors; ++v) LoadLanes(add.target[k] + i + v * kVector, &sums[k][v]);
  }
  for (int n = 0; n < add.samples; ++n) {
    std::array<Lanes4, kVectors> x;
    for (int v = 0; v < kVectors; ++v) {
      LoadLanes(add.from + static_cast<ptrdiff_t>(n) * add.size + i + v * kVector, &x[v]);
    }
    for (int k = 0; k < kEntries; ++k) {
      const double weight = add.weights[n * Stencil::kMaxSize + k];
      for (int v = 0; v < kVectors; ++v) sums[k][v] += weight * x[v];
    }
  }
  for (int k = 0; k < kEntries; ++k) {
    for (int v = 0; v < kVectors; ++v) StoreLanes(sums[k][v], add.target[k] + i + v * kVector);
  }
}

template <int kEntries>
TRILOBE_ALWAYS_INLINE void AddToEntries(const Addition& add) {
  int i = 0;
  for (; i + 2 * kVector <= add.size; i += 2 * kVector) AddVectors<kEntries, 2>(add, i);
  if (i < add.size) AddVectors<kEntries, 1>(add, i);
}

TRILOBE_ALWAYS_INLINE void AddTo(int entries, const Addition& add) {
  switch (entries) {
    case 4:
      AddToEntries<4>(add);
      break;
    case 3:
      AddToEntries<3>(add);
      break;
    case 2:
      AddToEntries<2>(add);
      break;
    default:
      AddToEntries<1>(add);
  }
}

// The end of the samples from `begin` on that `begins` has no bit for.
TRILOBE_ALWAYS_INLINE int EndOfRun(uint32_t begins, int begin, int size) {
  int end = begin + 1;
  while (end < size && (begins >> end & 1) == 0) ++end;
  return end;
}

}  // namespace

ScatterBuffer::ScatterBuffer(const LookupOrder& order, const AccumulatorLayout& layout,
                             double* sums)
    : sums_(sums) {
  for (int r = 0; r < order.count(); ++r) {
    const AccumulatorRows& rows = layout.of(r);
    LookupBuffer& lookup = lookups_.emplace_back();
    lookup.rows = &rows;
    lookup.lines_size = (rows.own_lines - AccumulatorRows::kGradient) * rows.lanes;
    lookup.lines.resize(static_cast<size_t>(kMost) * lookup.lines_size);
    for (int q = 0; q <= r; ++q) {
      PairBuffer& pair = pairs_.emplace_back();
      pair.size = layout.of(q).tables * rows.lanes;
      pair.blocks = sums + rows.blocks[layout.RowsOf(q)];
      pair.products.resize(static_cast<size_t>(kMost) * pair.size);
    }
  }
}

double* ScatterBuffer::Read(int r, int number, const Cell& cell) {
  LookupBuffer& lookup = lookups_[r];
  const int n = size_ - 1;
  if (n == 0) {
    lookup.begins = 1;
  } else if (lookup.number[n - 1] != number) {
    lookup.begins |= uint32_t{1} << n;
  }
  lookup.number[n] = number;
  lookup.cell[n] = &cell;
  return lookup.weights[n].data();
}

TRILOBE_ALWAYS_INLINE void ScatterBuffer::AddLines(const LookupBuffer& lookup) const {
  const AccumulatorRows& rows = *lookup.rows;
  double* const own =
      sums_ + rows.own + static_cast<ptrdiff_t>(AccumulatorRows::kGradient) * rows.lanes;
  for (int begin = 0, end = 0; begin < size_; begin = end) {
    end = EndOfRun(lookup.begins, begin, size_);
    const Cell& cell = *lookup.cell[begin];
    Addition add{};
    add.samples = end - begin;
    add.size = lookup.lines_size;
    add.from = &lookup.lines[static_cast<size_t>(begin) * add.size];
    add.weights = lookup.weights[begin].data();
    for (int k = 0; k < cell.size; ++k) add.target[k] = own + cell.entry[k] * rows.own_size();
    AddTo(cell.size, add);
  }
}

TRILOBE_ALWAYS_INLINE void ScatterBuffer::AddProducts(const LookupBuffer& other,
                                                      const LookupBuffer& own,
                                                      const PairBuffer& pair) const {
  const AccumulatorRows& rows = *own.rows;
  const bool same = &other == &own;
  for (int begin = 0, end = 0; begin < size_; begin = end) {
    end = EndOfRun(other.begins | own.begins, begin, size_);
    const Cell &of_cell = *other.cell[begin], &cell = *own.cell[begin];
    Addition add{};
    std::array<Weights, kMost> weights;
    add.samples = end - begin;
    add.size = pair.size;
    add.from = &pair.products[static_cast<size_t>(begin) * add.size];
    for (int l = 0; l < of_cell.size; ++l) {
      // Within a lookup, those of two entries in the other order are the same.
      const int first = same ? l : 0;
      for (int n = begin; n < end; ++n) {
        Lanes4 own_weights;
        LoadLanes(own.weights[n].data(), &own_weights);
        StoreLanes(other.weights[n][l] * own_weights, weights[n - begin].data());
        if (same) weights[n - begin][l] *= 0.5;
      }
      add.weights = &weights[0][first];
      for (int k = first; k < cell.size; ++k) {
        add.target[k - first] =
            same && rows.by_cell
                ? pair.blocks + rows.InCell(own.number[begin], l) + k * pair.size
                : pair.blocks +
                      (static_cast<ptrdiff_t>(of_cell.entry[l]) * rows.entries + cell.entry[k]) *
                          pair.size;
      }
      AddTo(cell.size - first, add);
    }
  }
}

TRILOBE_MULTIVERSION
void ScatterBuffer::Flush() {
  if (size_ == 0) return;
  for (int r = 0; r < static_cast<int>(lookups_.size()); ++r) {
    const LookupBuffer& own = lookups_[r];
    if (own.rows->tables == 0) continue;
    AddLines(own);
    for (int q = 0; q <= r; ++q) {
      AddProducts(lookups_[q], own, pairs_[PairOf(q, r)]);
    }
  }
  size_ = 0;
}

}  // namespace trilobe
