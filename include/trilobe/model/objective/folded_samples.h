#ifndef TRILOBE_MODEL_OBJECTIVE_FOLDED_SAMPLES_H_
#define TRILOBE_MODEL_OBJECTIVE_FOLDED_SAMPLES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/stencil.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// A sample of the objective: a measured direction pair.
struct WeightedSample {
  SampleStencils stencils;
  Rgb weight{};  // w, per channel
  Rgb rho{};     // measured BRDF [1/sr]
};

// The table entries that a stencil reads, without weights; many samples share a cell.
struct Cell {
  int size = 0;
  std::array<int, Stencil::kMaxSize> entry{};  // each once
};

// Indices of a sample's lookups. A lookup is the value of a table at a sample, the sum over the
// entries e of a cell of weight_e table[e]. There is one of D per distinct stretch, one of F, and
// one of G for each direction.
struct LookupOrder {
  static constexpr int kMost = kMaxLobes + 3;

  int of_D = 1;  // number of lookups of D

  int F() const { return of_D; }
  int G_i() const { return of_D + 1; }
  int G_o() const { return of_D + 2; }
  int count() const { return of_D + 3; }
  Factor factor(int lookup) const {
    return lookup < F() ? Factor::kD : lookup == F() ? Factor::kF : Factor::kG;
  }
};

// Any samples, folded and sorted. Samples with the same stencils, also after exchanging directions,
// have the same model value and merge into one with
//   w = w1 + w2,  rho* = (w1 rho1 + w2 rho2) / w,
// and E = sum w (rho - rho*)^2 + constant, as in FoldedGrid. They are sorted by cells of G, then of
// D and F, so that consecutive samples access the same memory.
struct FoldedSamples {
  // One lookup, for all samples.
  struct Lookup {
    std::vector<uint16_t> cell;  // [size]
    // Weight of the cell's k-th entry, 0 beyond the last. [largest cell size of the table][size]
    std::vector<std::vector<double>> weight;
  };
  // Samples [begin, end) share both cells of G.
  struct Pair {
    int cell_i, cell_o, begin, end;
  };

  std::array<std::vector<Cell>, 3> cells;  // of D, F and G
  LookupOrder order;
  std::vector<Lookup> lookups;                        // [order.count()]
  std::vector<double> inverse_cosines;                // [size]
  std::array<std::vector<double>, kChannels> weight;  // [kChannels][size]
  std::array<std::vector<double>, kChannels> rho;     // [kChannels][size], [1/sr]
  std::vector<Pair> pairs;
  double constant = 0;         // the irreducible part of E
  double measured_energy = 0;  // sum w rho*^2 of the unfolded samples

  int size() const { return static_cast<int>(inverse_cosines.size()); }
  const std::vector<Cell>& cells_of(Factor factor) const { return cells[static_cast<int>(factor)]; }
  const std::vector<Cell>& cells_of(int lookup) const { return cells_of(order.factor(lookup)); }
};

FoldedSamples Fold(const std::vector<WeightedSample>& samples);

// The same without all samples in memory: each is made twice or more, by its number, in parallel.
using SampleMaker = std::function<WeightedSample(int)>;
FoldedSamples Fold(int count, const SampleMaker& make, int num_threads);

// The first of some samples, folded alone, in terms of the fold of all: those of a measurement,
// which samples of a prior follow. Takes 4 bytes per sample instead of the 160 of a fold; E of a
// model has the same bits.
struct FoldedPart {
  struct Value {
    Rgb weight{}, rho{};  // rho: [1/sr]
  };

  std::shared_ptr<const FoldedSamples> whole;
  std::vector<int> number;  // in `whole`, ascending. [size]
  // Folded samples that contain others besides these: their positions in `number`, and their
  // weights and values without the others.
  std::vector<std::pair<size_t, Value>> others;
  double constant = 0, measured_energy = 0;  // as FoldedSamples has them

  int size() const { return static_cast<int>(number.size()); }
};

// Same as Fold; also sets all of *part, of samples 0 to `first`, but for `whole`.
FoldedSamples FoldWithPart(int count, const SampleMaker& make, int num_threads, int first,
                           FoldedPart* part);

// Numbers [begin, end) of the part, as samples of their own, without pairs and sums.
FoldedSamples Gathered(const FoldedPart& part, int begin, int end);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_FOLDED_SAMPLES_H_
