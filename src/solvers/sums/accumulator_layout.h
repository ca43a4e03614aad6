#ifndef TRILOBE_SOLVERS_SUMS_ACCUMULATOR_LAYOUT_H_
#define TRILOBE_SOLVERS_SUMS_ACCUMULATOR_LAYOUT_H_

#include <algorithm>
#include <cstddef>
#include <vector>

#include "solvers/sums/kind.h"
#include "trilobe/core/math/stencil.h"

namespace trilobe {

// Where the sums w v r and w v v' of AddNormalEquations lie in memory: those of one kind, or, of D,
// of its tables that are read by one stretch. Each
// entry of its tables (of amplitudes, each channel; their tables are s of each lobe, then d) has
// lines of its own: its squared length, its gradient, and its products with amplitudes. Products
// with entries of kinds before it are in blocks, one a pair of entries: those for one entry of the
// other kind follow each other, as do the entries that a sample reads. So are products within G,
// which a sample reads twice. Within D and F, which it reads once, only entries of one cell have
// any; there they are by cell. A line is a vector over the kind's tables.
struct AccumulatorRows {
  static constexpr int kSquaredLength = 0, kGradient = 1, kFirstAmplitude = 2;

  Kind kind = Kind::kAmplitudes;
  bool by_cell = false;
  int entries = 0, tables = 0, lanes = 0, own_lines = 0;
  std::vector<int> table;      // its number among those of the kind. [tables]
  std::vector<int> lane;       // [tables]
  std::vector<int> parameter;  // [entries][tables]
  size_t own = 0;              // [entries][own_lines][lanes] begin here
  // With each of the rows up to these: [their entries][entries][their tables][lanes]; with
  // themselves by_cell [cells][Stencil::kMaxSize][Stencil::kMaxSize][tables][lanes].
  std::vector<size_t> blocks;
  size_t own_size() const { return static_cast<size_t>(own_lines) * lanes; }
  // Where the blocks begin of the k-th entry of a cell with all entries of it.
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

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_ACCUMULATOR_LAYOUT_H_
