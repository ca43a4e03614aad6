#ifndef TRILOBE_SOLVERS_SUMS_ACCUMULATORS_H_
#define TRILOBE_SOLVERS_SUMS_ACCUMULATORS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solvers/sums/parameter_kind.h"
#include "trilobe/core/base/stencil.h"
#include "trilobe/model/objective/folded_samples.h"

namespace trilobe {

// Memory layout of the sums w v r and w v v' of AddNormalEquations for one kind of parameters or,
// for D, for its tables that are read by one stretch. Each entry of its tables has lines of its
// own: its squared length, its gradient, and its products with amplitudes. (For amplitudes, entries
// are channels, and tables are s of each lobe, then d.) Products with entries of kinds before it
// are in blocks, one per pair of entries: those for one entry of the other kind follow each other,
// as do the entries that a sample reads. The same holds within G, which a sample reads twice.
// Within D and F, which it reads once, only entries of one cell have products, which are stored by
// cell. A line is a vector over the kind's tables.
struct AccumulatorRows {
  static constexpr int kSquaredLength = 0, kGradient = 1, kFirstAmplitude = 2;

  ParameterKind kind = ParameterKind::kAmplitudes;
  bool by_cell = false;
  int entries = 0, tables = 0, lanes = 0, own_lines = 0;
  std::vector<int> table;      // its number among those of the kind. [tables]
  std::vector<int> lane;       // [tables]
  std::vector<int> parameter;  // [entries][tables]
  size_t own = 0;              // [entries][own_lines][lanes] begin here
  // Offsets of the blocks with each of the rows up to these,
  // [their entries][entries][their tables][lanes]; with themselves by_cell,
  // [cells][Stencil::kMaxSize][Stencil::kMaxSize][tables][lanes].
  std::vector<size_t> blocks;
  size_t own_size() const { return static_cast<size_t>(own_lines) * lanes; }
  // Offset, by_cell, of the blocks of a cell's k-th entry with all entries of the cell.
  size_t InCell(int cell, int k) const {
    return (static_cast<size_t>(cell) * Stencil::kMaxSize + k) * Stencil::kMaxSize * tables * lanes;
  }
};

struct AccumulatorLayout {
  std::vector<AccumulatorRows> rows;  // of the amplitudes, of D for each stretch, of F and of G
  size_t size = 0;                    // of all sums

  const AccumulatorRows& amplitudes() const { return rows[0]; }
  // Both lookups of G have the last.
  int RowsOf(int lookup) const { return std::min(1 + lookup, static_cast<int>(rows.size()) - 1); }
  const AccumulatorRows& of(int lookup) const { return rows[RowsOf(lookup)]; }
};

// Adds what samples have for pairs of lookups (the bracket in AddNormalEquations) to the sums of
// the entries e and f of both:
//   sums[e][f] += weight_e weight_f product.
// Samples are kept until there are kMost; then a sum is read and written once for all that follow
// each other and have the same cells, as sorted samples do.
class ScatterBuffer {
 public:
  static constexpr int kMost = 8;

  // The layout must outlive this.
  ScatterBuffer(const LookupOrder& order, const AccumulatorLayout& layout, double* sums);

  // Begins a sample, of which everything below is to be set. After the last one: Flush.
  void Next() {
    if (size_ == kMost) Flush();
    ++size_;
  }
  // Sets the cell that the sample reads by lookup r, and its number; returns where to write the
  // weights of its entries.
  double* Read(int r, int number, const Cell& cell);
  // Output for the lines of an entry that lookup r reads, from the gradient on, and for its
  // products with an entry that lookup q <= r reads, [tables of q][lanes]: without the weights of
  // entries.
  double* Lines(int r) {
    return &lookups_[r].lines[static_cast<size_t>(size_ - 1) * lookups_[r].lines_size];
  }
  double* Products(int q, int r) {
    PairBuffer& pair = pairs_[PairOf(q, r)];
    return &pair.products[static_cast<size_t>(size_ - 1) * pair.size];
  }

  void Flush();

 private:
  using Weights = std::array<double, Stencil::kMaxSize>;
  struct LookupBuffer {
    const AccumulatorRows* rows;
    int lines_size;
    uint32_t begins;  // bit n: sample n has another cell than the one before
    std::array<const Cell*, kMost> cell;
    std::array<int, kMost> number;
    std::array<Weights, kMost> weights;
    std::vector<double> lines;  // [kMost][lines_size]
  };
  struct PairBuffer {
    int size;
    double* blocks;
    std::vector<double> products;  // [kMost][size]
  };
  static int PairOf(int q, int r) { return r * (r + 1) / 2 + q; }
  void AddLines(const LookupBuffer& lookup) const;
  void AddProducts(const LookupBuffer& other, const LookupBuffer& own,
                   const PairBuffer& pair) const;

  double* const sums_;
  int size_ = 0;
  std::vector<LookupBuffer> lookups_;
  std::vector<PairBuffer> pairs_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_ACCUMULATORS_H_
