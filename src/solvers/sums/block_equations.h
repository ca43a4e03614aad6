#ifndef TRILOBE_SOLVERS_SUMS_BLOCK_EQUATIONS_H_
#define TRILOBE_SOLVERS_SUMS_BLOCK_EQUATIONS_H_

#include <span>
#include <vector>

#include "solvers/sums/parameter_kind.h"
#include "solvers/sums/sample_lookups.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The normal equations of a block of parameters x in which E is quadratic: d and s, or tables of D
// or F that every sample reads once, by one stencil:
//   E(x + delta) - E(x) = delta'H delta + 2 g'delta,
//   g = sum w v r,  H = sum w v v'  over samples and channels,  r = rho - rho*,  v = d rho / d x.
// AWLS solves them parameter by parameter and updates g after each (ScatteredEquations has the
// equations of all parameters). H is stored by cells, since only entries of one cell have products.
// Amplitudes are treated as tables: d, then s of each lobe, with one entry, and cell, per channel.
class BlockEquations {
 public:
  // For the tables [first, last) of a kind, which one lookup must read; for amplitudes, all.
  BlockEquations(const SampleLookups& lookups, ParameterKind kind, int first, int last);

  // Sets the sums for a model whose tables have been read. The same bits for any number of threads.
  void Accumulate(const FactorModel& model);

  // Sets an entry of these tables (ascending) to the minimum of E with all others held, and updates
  // the sums. E: of the model of Accumulate; needed for more than one table (MoveToMinimum).
  void Update(int entry, std::span<const int> tables, double E, FactorModel* model);

  ParameterKind kind() const { return kind_; }
  int entries() const { return static_cast<int>(readers_.size()); }
  int first() const { return first_; }
  int last() const { return last_; }

 private:
  // Two tables that serve some of the same channels, t <= u: their numbers from first_.
  struct Pair {
    int t, u;
    ModelSpec::ChannelRange channels;
  };
  // A cell that contains an entry, as its k-th.
  struct Reader {
    int cell, k;
  };

  static int PairOf(int k, int l) { return k >= l ? k * (k + 1) / 2 + l : PairOf(l, k); }
  int tables() const { return last_ - first_; }
  // Offset of the sums of H for a cell's k-th and l-th entries: [pair_lanes_].
  size_t InCell(int cell, int k, int l) const {
    return of_cells_ + (static_cast<size_t>(cell) * pairs_in_cell_ + PairOf(k, l)) * pair_lanes_;
  }
  void AddBatch(int begin, int end, const SampleLookups::Batch& batch,
                std::vector<double>* sums) const;
  void AddAmplitudes(int begin, int end, const SampleLookups::Batch& batch,
                     std::vector<double>* sums) const;

  const SampleLookups& lookups_;
  const ParameterKind kind_;
  const int first_, last_;
  std::vector<Cell> cells_;
  std::vector<std::vector<Reader>> readers_;  // [entry]
  std::vector<Pair> pairs_;
  std::vector<int> pair_of_;  // by numbers of two tables; -1: of none. [tables][tables]
  int table_lanes_, pair_lanes_, pairs_in_cell_;
  // The gradient is [entries][table_lanes_], and after it, from of_cells_ on, is H:
  // [cells][pairs_in_cell_][pair_lanes_].
  size_t of_cells_;
  std::vector<std::vector<double>> sums_;  // of parts of the samples; all are in the first
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_BLOCK_EQUATIONS_H_
