#include "trilobe/model/objective/folded_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <tuple>
#include <type_traits>
#include <utility>

#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// The distinct cells of one table.
class CellIndex {
 public:
  int Find(const Stencil& stencil) {
    const size_t first = stencil.index[0];
    if (first >= by_first_entry_.size()) by_first_entry_.resize(first + 1);
    for (const int id : by_first_entry_[first]) {
      const Cell& cell = cells_[id];
      if (cell.size == stencil.size &&
          std::equal(cell.entry.begin(), cell.entry.begin() + cell.size, stencil.index.begin())) {
        return id;
      }
    }
    const int id = static_cast<int>(cells_.size());
    by_first_entry_[first].push_back(id);
    Cell& cell = cells_.emplace_back();
    cell.size = stencil.size;
    std::copy_n(stencil.index.begin(), stencil.size, cell.entry.begin());
    return id;
  }

  // Sorts the cells by entries and returns the new number of each.
  std::vector<int> Sort() {
    std::vector<int> order(cells_.size()), rank(cells_.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, [&](int a, int b) { return Key(a) < Key(b); });
    std::vector<Cell> sorted;
    for (const int id : order) {
      rank[id] = static_cast<int>(sorted.size());
      sorted.push_back(cells_[id]);
    }
    cells_ = std::move(sorted);
    return rank;
  }

  std::vector<Cell>& cells() { return cells_; }

 private:
  std::pair<std::array<int, Stencil::kMaxSize>, int> Key(int id) const {
    return {cells_[id].entry, cells_[id].size};
  }

  std::vector<Cell> cells_;
  std::vector<std::vector<int>> by_first_entry_;
};

// At and between neighbouring nodes of a table there are at most four kinds of cells per node.
static_assert(4 * kMaxTableSize <= std::numeric_limits<uint16_t>::max());

// A sample to be sorted.
struct Item {
  std::array<uint16_t, LookupOrder::kMost> cell{};  // G first: theta_i, theta_o, D, F
  bool smaller_i = false;  // the weights of theta_i are smaller than those of theta_o
  bool exchanged = false;  // theta_i and theta_o
  int sample = 0;
  uint64_t hash = 0, hash_exchanged = 0;  // of the weights, rounded

  auto Key() const { return std::tie(cell, hash, sample); }
};

LookupOrder OrderOf(const SampleStencils& at) {
  return {.of_D = 1 + static_cast<int>(at.more_D.size())};
}

const Stencil& StencilOf(const SampleStencils& at, const LookupOrder& order, int lookup,
                         bool exchanged) {
  if (lookup < order.F()) return at.DOf(lookup);
  if (lookup == order.F()) return at.F;
  return (lookup == order.G_i()) != exchanged ? at.G_i : at.G_o;
}

// Position of a lookup's cell in an item: G comes first.
int PlaceInItem(const LookupOrder& order, int lookup) { return (lookup + 2) % order.count(); }

// Equal for weights that differ by rounding, except for a few in a million.
uint64_t RoundedHash(const SampleStencils& at, bool exchanged) {
  uint64_t hash = 0;
  const LookupOrder order = OrderOf(at);
  for (int r = 0; r < order.count(); ++r) {
    const Stencil& stencil = StencilOf(at, order, r, exchanged);
    for (int k = 0; k < stencil.size; ++k) {
      const auto rounded = static_cast<uint64_t>(std::llround(stencil.weight[k] * 0x1p36));
      hash = (hash ^ rounded) * 0x9e3779b97f4a7c15U;
      hash ^= hash >> 29;
    }
  }
  return hash;
}

// Whether all models have the same value up to the rounding of an exchanged pair's directions.
bool ReadAlike(const WeightedSample& a, bool a_exchanged, const WeightedSample& b,
               bool b_exchanged) {
  constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
  const LookupOrder order = OrderOf(a.stencils);
  for (int r = 0; r < order.count(); ++r) {
    const Stencil& of_a = StencilOf(a.stencils, order, r, a_exchanged);
    const Stencil& of_b = StencilOf(b.stencils, order, r, b_exchanged);
    if (of_a.size != of_b.size) return false;
    for (int k = 0; k < of_a.size; ++k) {
      if (of_a.index[k] != of_b.index[k]) return false;
      if (!(std::abs(of_a.weight[k] - of_b.weight[k]) <= kRounding)) return false;
    }
  }
  const double cosines = a.stencils.inverse_cosines;
  return std::abs(cosines - b.stencils.inverse_cosines) <= kRounding * cosines;
}

// Calls use(k, sample number(k)) for k from 0 to `count`, in this order. The samples are made in
// parallel, a block at a time.
template <typename Number, typename Use>
void ForSamples(int count, const SampleMaker& make, int num_threads, const Number& number,
                const Use& use) {
  constexpr int kChunk = 1024, kBlock = 16 * kChunk;
  std::vector<WeightedSample> block(std::min(count, kBlock));
  for (int first = 0; first < count; first += kBlock) {
    const int size = std::min(kBlock, count - first);
    ParallelFor((size + kChunk - 1) / kChunk, num_threads, [&](int chunk) {
      for (int k = chunk * kChunk; k < std::min((chunk + 1) * kChunk, size); ++k) {
        block[k] = make(number(first + k));
      }
    });
    for (int k = 0; k < size; ++k) use(first + k, block[k]);
  }
}

std::vector<Item> Sorted(int count, const SampleMaker& make, int num_threads,
                         FoldedSamples* folded) {
  std::array<CellIndex, 3> index;
  const auto find = [&](Factor factor, const Stencil& stencil) {
    return static_cast<uint16_t>(index[static_cast<int>(factor)].Find(stencil));
  };
  const LookupOrder& order = folded->order;
  std::vector<Item> items(count);
  ForSamples(count, make, num_threads, std::identity(), [&](int j, const WeightedSample& sample) {
    const SampleStencils& at = sample.stencils;
    Item& item = items[j];
    for (int r = 0; r < order.count(); ++r) {
      item.cell[PlaceInItem(order, r)] =
          find(order.factor(r), StencilOf(at, order, r, /*exchanged=*/false));
    }
    item.smaller_i = at.G_i.weight < at.G_o.weight;
    item.sample = j;
    item.hash = RoundedHash(at, /*exchanged=*/false);
    item.hash_exchanged = RoundedHash(at, /*exchanged=*/true);
  });
  std::array<std::vector<int>, 3> rank;
  for (int f = 0; f < 3; ++f) {
    rank[f] = index[f].Sort();
    folded->cells[f] = std::move(index[f].cells());
  }
  for (Item& item : items) {
    for (int r = 0; r < order.count(); ++r) {
      uint16_t& cell = item.cell[PlaceInItem(order, r)];
      cell = static_cast<uint16_t>(rank[static_cast<int>(order.factor(r))][cell]);
    }
    item.exchanged =
        item.cell[0] < item.cell[1] || (item.cell[0] == item.cell[1] && item.smaller_i);
    if (!item.exchanged) continue;
    std::swap(item.cell[0], item.cell[1]);
    item.hash = item.hash_exchanged;
  }
  std::ranges::sort(items, [](const Item& a, const Item& b) { return a.Key() < b.Key(); });
  return items;
}

// The samples in their order, with those of a run, which become one, side by side.
struct Order {
  std::vector<int> sample;
  std::vector<int> begin;       // of each run, and the end of the last
  std::vector<bool> exchanged;  // the first sample of each run

  size_t runs() const { return exchanged.size(); }
};

// Sets the cells of the samples. The items, which need a third of the memory of the weights, are
// gone before those are made.
Order SetCells(int count, const SampleMaker& make, int num_threads, FoldedSamples* folded) {
  const std::vector<Item> items = Sorted(count, make, num_threads, folded);
  Order order;
  for (size_t n = 0; n < items.size(); ++n) {
    order.sample.push_back(items[n].sample);
    if (n > 0) {
      const Item &item = items[n], &first = items[order.begin.back()];
      if (item.cell == first.cell && item.hash == first.hash &&
          ReadAlike(make(first.sample), first.exchanged, make(item.sample), item.exchanged)) {
        continue;
      }
    }
    order.begin.push_back(static_cast<int>(n));
    order.exchanged.push_back(items[n].exchanged);
  }
  folded->lookups.resize(folded->order.count());
  for (FoldedSamples::Lookup& lookup : folded->lookups) lookup.cell.resize(order.runs());
  std::vector<FoldedSamples::Pair>& pairs = folded->pairs;
  for (size_t n = 0; n < order.runs(); ++n) {
    const Item& item = items[order.begin[n]];
    for (int r = 0; r < folded->order.count(); ++r) {
      folded->lookups[r].cell[n] = item.cell[PlaceInItem(folded->order, r)];
    }
    const int j = static_cast<int>(n);
    if (n == 0 || pairs.back().cell_i != item.cell[0] || pairs.back().cell_o != item.cell[1]) {
      pairs.push_back({item.cell[0], item.cell[1], j, j});
    }
    ++pairs.back().end;
  }
  order.begin.push_back(count);
  return order;
}

// Sets the weights by which sample n reads tables.
void SetWeights(const SampleStencils& at, bool exchanged, size_t n, FoldedSamples* folded) {
  folded->inverse_cosines[n] = at.inverse_cosines;
  for (int r = 0; r < folded->order.count(); ++r) {
    FoldedSamples::Lookup& lookup = folded->lookups[r];
    const Stencil& stencil = StencilOf(at, folded->order, r, exchanged);
    for (int k = 0; k < stencil.size; ++k) lookup.weight[k][n] = stencil.weight[k];
  }
}

// Weights and values of the samples of a run, which become one.
struct Run {
  std::vector<std::pair<Rgb, Rgb>> samples;

  // Merges the first `count` samples; adds to the sums over all.
  FoldedPart::Value Merge(size_t count, double* constant, double* measured_energy) const {
    FoldedPart::Value merged;
    for (int c = 0; c < kChannels; ++c) {
      double w = 0, rho = 0;
      for (size_t k = 0; k < count; ++k) {
        const double more = samples[k].first[c], own = samples[k].second[c];
        *measured_energy += more * own * own;
        // The old mean plus a fraction of the difference: exact if both are equal.
        const double share = k == 0 ? 1 : w + more > 0 ? more / (w + more) : 0;
        const double difference = own - rho;
        *constant += w * share * difference * difference;
        rho += share * difference;
        w += more;
      }
      merged.weight[c] = w;
      merged.rho[c] = rho;
    }
    return merged;
  }
};

}  // namespace

FoldedSamples Fold(const std::vector<WeightedSample>& samples) {
  return Fold(
      static_cast<int>(samples.size()), [&](int j) { return samples[j]; },
      /*num_threads=*/1);
}

FoldedSamples Fold(int count, const SampleMaker& make, int num_threads) {
  FoldedPart none;
  return FoldWithPart(count, make, num_threads, /*first=*/0, &none);
}

FoldedSamples FoldWithPart(int count, const SampleMaker& make_one, int num_threads, int first,
                           FoldedPart* part) {
  // Each sample is made for its cells, and again for its weights. Few are made once.
  constexpr int kFew = 1 << 16;  // they take some 30 MB
  std::vector<WeightedSample> few;
  SampleMaker make = make_one;
  if (count <= kFew) {
    ForSamples(count, make_one, num_threads, std::identity(),
               [&](int /*j*/, const WeightedSample& sample) { few.push_back(sample); });
    make = [&few](int j) { return few[j]; };
  }
  FoldedSamples folded;
  if (count > 0) folded.order = OrderOf(make(0).stencils);
  const Order order = SetCells(count, make, num_threads, &folded);
  const size_t size = order.runs();
  folded.inverse_cosines.resize(size);
  for (int r = 0; r < folded.order.count(); ++r) {
    int width = 0;
    for (const Cell& cell : folded.cells_of(r)) width = std::max(width, cell.size);
    folded.lookups[r].weight.assign(width, std::vector<double>(size));
  }
  for (int c = 0; c < kChannels; ++c) {
    folded.weight[c].resize(size);
    folded.rho[c].resize(size);
  }
  Run run;
  size_t n = 0;
  size_t of_part = 0;  // in the run: those come first, as they have the lower numbers
  const auto number = [&](int i) { return order.sample[i]; };
  const auto end_run = [&] {
    const int j = static_cast<int>(n);
    const FoldedPart::Value merged =
        run.Merge(run.samples.size(), &folded.constant, &folded.measured_energy);
    for (int c = 0; c < kChannels; ++c) {
      folded.weight[c][n] = merged.weight[c];
      folded.rho[c][n] = merged.rho[c];
    }
    if (of_part > 0) {
      part->number.push_back(j);
      const FoldedPart::Value own = run.Merge(of_part, &part->constant, &part->measured_energy);
      if (of_part < run.samples.size()) part->others.emplace_back(part->number.size() - 1, own);
    }
    run.samples.clear();
    of_part = 0;
    ++n;
  };
  ForSamples(count, make, num_threads, number, [&](int i, const WeightedSample& sample) {
    if (i == order.begin[n]) SetWeights(sample.stencils, order.exchanged[n], n, &folded);
    run.samples.emplace_back(sample.weight, sample.rho);
    if (order.sample[i] < first) ++of_part;
    if (i + 1 == order.begin[n + 1]) end_run();
  });
  return folded;
}

FoldedSamples Gathered(const FoldedPart& part, int begin, int end) {
  const FoldedSamples& whole = *part.whole;
  FoldedSamples some;
  some.cells = whole.cells;
  some.order = whole.order;
  const auto gather = [&](const auto& from) {
    std::remove_cvref_t<decltype(from)> to(end - begin);
    for (int j = begin; j < end; ++j) to[j - begin] = from[part.number[j]];
    return to;
  };
  for (const FoldedSamples::Lookup& lookup : whole.lookups) {
    FoldedSamples::Lookup& own = some.lookups.emplace_back();
    own.cell = gather(lookup.cell);
    for (const std::vector<double>& weight : lookup.weight) own.weight.push_back(gather(weight));
  }
  some.inverse_cosines = gather(whole.inverse_cosines);
  for (int c = 0; c < kChannels; ++c) {
    some.weight[c] = gather(whole.weight[c]);
    some.rho[c] = gather(whole.rho[c]);
  }
  const auto is_before = [](const auto& other, int j) { return static_cast<int>(other.first) < j; };
  const auto from = std::lower_bound(part.others.begin(), part.others.end(), begin, is_before);
  const auto to = std::lower_bound(from, part.others.end(), end, is_before);
  for (auto other = from; other != to; ++other) {
    const auto& [place, value] = *other;
    for (int c = 0; c < kChannels; ++c) {
      some.weight[c][place - begin] = value.weight[c];
      some.rho[c][place - begin] = value.rho[c];
    }
  }
  return some;
}

}  // namespace trilobe
