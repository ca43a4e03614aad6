#ifndef TRILOBE_SOLVERS_SUMS_SCATTER_BUFFER_H_
#define TRILOBE_SOLVERS_SUMS_SCATTER_BUFFER_H_

#include <array>
#include <cstdint>
#include <vector>

#include "solvers/sums/accumulator_layout.h"
#include "trilobe/core/math/stencil.h"
#include "trilobe/model/objective/folded_samples.h"

namespace trilobe {

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
  // The cell that it reads by lookup r, and its number; returns where the weights of its entries
  // go.
  double* Read(int r, int number, const Cell& cell);
  // Where lines of an entry go that lookup r reads, from the gradient on, and products with an
  // entry that lookup q <= r reads, [tables of q][lanes]: before any weight of an entry.
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

#endif  // TRILOBE_SOLVERS_SUMS_SCATTER_BUFFER_H_
