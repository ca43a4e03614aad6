#ifndef TRILOBE_SUMS_SAMPLE_RUN_H_
#define TRILOBE_SUMS_SAMPLE_RUN_H_

#include <array>
#include <cstdint>
#include <vector>

#include "sums/sample_layout.h"
#include "trilobe/math/stencil.h"
#include "trilobe/objective/folded_samples.h"

namespace trilobe {

// What samples that follow each other add to the sums of the table entries that they read. It is
// kept until there are kMost of them; then a sum is read and written once for all that read it one
// after the other, as sorted samples do.
class SampleRun {
 public:
  static constexpr int kMost = 8;

  // The layout must outlive this.
  SampleRun(const ReadingOrder& order, const SampleLayout& layout, double* sums);

  // Begins a sample, of which everything below is to be set. After the last one: Flush.
  void Next() {
    if (size_ == kMost) Flush();
    ++size_;
  }
  // The cell that it reads by reading r, and its number; returns where the weights of its entries
  // go.
  double* Read(int r, int number, const Cell& cell);
  // Where lines of an entry go that reading r reads, from the gradient on, and products with an
  // entry that reading q <= r reads, [tables of q][lanes]: before any weight of an entry.
  double* Lines(int r) {
    return &readings_[r].lines[static_cast<size_t>(size_ - 1) * readings_[r].lines_size];
  }
  double* Products(int q, int r) {
    OfPair& of = pairs_[PairOf(q, r)];
    return &of.products[static_cast<size_t>(size_ - 1) * of.size];
  }

  void Flush();

 private:
  using Weights = std::array<double, Stencil::kMaxSize>;
  struct OfReading {
    const SampleRows* rows;
    int lines_size;
    uint32_t begins;  // bit n: sample n has another cell than the one before
    std::array<const Cell*, kMost> cell;
    std::array<int, kMost> number;
    std::array<Weights, kMost> weights;
    std::vector<double> lines;  // [kMost][lines_size]
  };
  struct OfPair {
    int size;
    double* blocks;
    std::vector<double> products;  // [kMost][size]
  };
  static int PairOf(int q, int r) { return r * (r + 1) / 2 + q; }
  void AddLines(const OfReading& of) const;
  void AddProducts(const OfReading& of, const OfReading& own, const OfPair& pair) const;

  double* const sums_;
  int size_ = 0;
  std::vector<OfReading> readings_;
  std::vector<OfPair> pairs_;
};

}  // namespace trilobe

#endif  // TRILOBE_SUMS_SAMPLE_RUN_H_
