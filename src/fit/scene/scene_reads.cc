#include "fit/scene/scene_reads.h"

#include <algorithm>
#include <map>
#include <utility>
#include <variant>

#include "trilobe/model/lobes/reconstruct.h"

namespace trilobe {
namespace {

// Parts of the phi_d of a place, and its bins of theta_d.
constexpr int kPhiParts = 3, kThetaDs = 2;

// The place of a bin: its theta_h, a pair of theta_d, and a part of the phi_d.
class Places {
 public:
  explicit Places(const MerlGrid& grid) : grid_(grid) {}

  int operator()(int bin) const {
    const int p = bin % grid_.phi_d, folded = std::min(p, grid_.phi_d - 1 - p);
    const int row = bin / grid_.phi_d, h = row / grid_.theta_d, d = row % grid_.theta_d;
    return (h * grid_.theta_d + d / kThetaDs) * kPhiParts +
           folded * kPhiParts / ((grid_.phi_d + 1) / 2);
  }

 private:
  const MerlGrid grid_;
};

}  // namespace

SceneReads::SceneReads(const BrdfSamples& all, BrdfSamples used, const SceneDirections& directions)
    : used_(std::move(used)) {
  for (int j = 0; j < used_.size(); ++j) cosines_.push_back(used_.CosinesOf(j));
  if (const auto* const list = std::get_if<DirectionList>(&directions)) {
    AddPairs(*list);
  } else {
    AddCells(all);
  }
}

void SceneReads::AddPairs(const DirectionList& list) {
  const SamplesOfBins samples_of(used_);
  for (const HalfDiffAngles& angles : list.directions) {
    std::vector<Share> shares;
    for (const BinShare& bin : BinsAround(used_.grid, angles)) {
      const std::vector<int>& inside = samples_of(bin.bin);
      for (const int j : inside) {
        shares.push_back({j, bin.share / static_cast<double>(inside.size())});
      }
    }
    AddRead(shares, 1);
  }
}

void SceneReads::AddCells(const BrdfSamples& all) {
  const Places place_of(used_.grid);
  struct Cell {
    std::vector<Share> shares;
    double weight = 0;
    std::vector<int> around;
  };
  std::map<int, Cell> cells;
  for (int j = 0; j < used_.size(); ++j) {
    const double light = used_.counted ? 1 : used_.SolidAngle(j) * cosines_[j].i * cosines_[j].o;
    Cell& cell = cells[place_of(BinOf(used_, j))];
    cell.shares.push_back({j, light * used_.Multiplicity(j)});
    cell.weight += cell.shares.back().share;
  }
  for (int j = 0; j < all.size(); ++j) {
    const auto cell = cells.find(place_of(BinOf(all, j)));
    if (cell != cells.end()) cell->second.around.push_back(j);
  }
  std::vector<int> read_of(all.rho.size(), -1);
  for (const auto& [place, cell] : cells) {
    if (!AddRead(cell.shares, cell.weight)) continue;
    for (const int j : cell.around) read_of[j] = static_cast<int>(reads_.size()) - 1;
  }
  std::vector<int> around;
  for (int j = 0; j < all.size(); ++j) {
    if (read_of[j] < 0) continue;
    around.push_back(j);
    read_of_around_.push_back(read_of[j]);
  }
  around_ = Selected(all, around);
}

bool SceneReads::AddRead(const std::vector<Share>& shares, double weight) {
  double sum = 0;
  for (const Share& share : shares) sum += share.share;
  if (!(sum > 0)) return false;
  const int begin = static_cast<int>(shares_.size());
  for (const auto& [sample, share] : shares) {
    if (share > 0) shares_.push_back({sample, share / sum});
  }
  reads_.push_back({begin, static_cast<int>(shares_.size()), weight});
  return true;
}

SeenPatch SceneReads::PatchOf(const Read& read, const std::vector<Rgb>& fitted) const {
  SeenPatch patch{.cosines = {0, 0}, .weight = read.weight};
  for (int k = read.begin; k < read.end; ++k) {
    const auto [j, share] = shares_[k];
    patch.cosines.i += share * cosines_[j].i;
    patch.cosines.o += share * cosines_[j].o;
    for (int c = 0; c < kChannels; ++c) {
      patch.measured[c] += share * used_.rho[j][c];
      patch.fitted[c] += share * fitted[j][c];
    }
  }
  return patch;
}

SeenError SceneReads::Compare(const FactorModel& model, int num_threads) const {
  const std::vector<Rgb> fitted = EvaluateSamples(model, used_, num_threads);
  std::vector<SeenPatch> patches;
  patches.reserve(reads_.size());
  for (const Read& read : reads_) patches.push_back(PatchOf(read, fitted));
  if (around_.size() == 0) return ComparePatches(patches);
  const std::vector<Rgb> fitted_around = EvaluateSamples(model, around_, num_threads);
  struct Sums {
    Rgb measured{}, fitted{};
  };
  std::vector<Sums> sums(reads_.size());
  for (int k = 0; k < around_.size(); ++k) {
    Sums& sum = sums[read_of_around_[k]];
    for (int c = 0; c < kChannels; ++c) {
      sum.measured[c] += around_.rho[k][c];
      sum.fitted[c] += fitted_around[k][c];
    }
  }
  for (size_t k = 0; k < patches.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) {
      if (!(sums[k].fitted[c] > 0)) continue;
      patches[k].measured[c] = patches[k].fitted[c] * (sums[k].measured[c] / sums[k].fitted[c]);
    }
  }
  return ComparePatches(patches);
}

}  // namespace trilobe
