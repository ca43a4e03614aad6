#include "fit/scene/scene_reads.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <variant>

#include "trilobe/model/objective/reconstruct.h"

namespace trilobe {
namespace {

// Parts of the phi_d of a place, and its bins of theta_d.
constexpr int kPhiParts = 3, kThetaDs = 2;

// The place of a bin: its theta_h, a pair of theta_d, and a part of the phi_d.
int PlaceOf(const MerlGrid& grid, int bin) {
  const int p = bin % grid.phi_d, folded = std::min(p, grid.phi_d - 1 - p);
  const int row = bin / grid.phi_d, h = row / grid.theta_d, d = row % grid.theta_d;
  return (h * grid.theta_d + d / kThetaDs) * kPhiParts +
         folded * kPhiParts / ((grid.phi_d + 1) / 2);
}

}  // namespace

SceneReads::SceneReads(const BrdfSamples& all, BrdfSamples used, const SceneDirections& directions)
    : used_(std::move(used)) {
  for (int j = 0; j < used_.size(); ++j) cosines_.push_back(used_.CosinesOf(j));
  if (const auto* const list = std::get_if<DirectionList>(&directions)) {
    AddPairs(*list);
  } else {
    AddCells();
    if (used_.on_grid()) FindNeighbours(all);
  }
}

void SceneReads::FindNeighbours(const BrdfSamples& all) {
  const MerlGrid& grid = used_.grid;
  const int reach = grid.phi_d * 15 / 180;
  std::vector<bool> row_is_read(static_cast<size_t>(grid.theta_h) * grid.theta_d);
  for (const int bin : used_.bins) row_is_read[bin / grid.phi_d] = true;
  std::vector<int> numbers, around_of(grid.size(), -1);
  for (int j = 0; j < all.size(); ++j) {
    if (!row_is_read[all.bins[j] / grid.phi_d]) continue;
    around_of[all.bins[j]] = static_cast<int>(numbers.size());
    numbers.push_back(j);
  }
  around_ = Selected(all, numbers);
  for (const int bin : used_.bins) {
    const int p = bin % grid.phi_d, row = bin - p;
    for (const int center : {p, grid.phi_d - 1 - p}) {
      for (int phi = center - reach; phi <= center + reach; ++phi) {
        const int near = around_of[row + (phi + grid.phi_d) % grid.phi_d];
        if (near >= 0) neighbours_.push_back(near);
      }
    }
    neighbours_end_.push_back(static_cast<int64_t>(neighbours_.size()));
  }
}

std::vector<Rgb> SceneReads::MeasuredLike(const std::vector<Rgb>& fitted, const FactorModel& model,
                                          int num_threads) const {
  if (around_.size() == 0) return used_.rho;
  const std::vector<Rgb> fitted_around = EvaluateSamples(model, around_, num_threads);
  std::vector<Rgb> measured(fitted.size());
  int64_t k = 0;
  for (size_t j = 0; j < fitted.size(); ++j) {
    Rgb of_measured{}, of_fitted{};
    const int64_t begin = k;
    for (; k < neighbours_end_[j]; ++k) {
      for (int c = 0; c < kChannels; ++c) {
        of_measured[c] += around_.rho[neighbours_[k]][c];
        of_fitted[c] += fitted_around[neighbours_[k]][c];
      }
    }
    for (int c = 0; c < kChannels; ++c) {
      measured[j][c] = of_fitted[c] > 0 ? fitted[j][c] * (of_measured[c] / of_fitted[c])
                                        : of_measured[c] / static_cast<double>(k - begin);
    }
  }
  return measured;
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

void SceneReads::AddCells() {
  std::map<int, std::pair<std::vector<Share>, double>> cells;
  for (int j = 0; j < used_.size(); ++j) {
    const double light = used_.counted ? 1 : used_.SolidAngle(j) * cosines_[j].i * cosines_[j].o;
    auto& [shares, weight] = cells[PlaceOf(used_.grid, BinOf(used_, j))];
    shares.push_back({j, light * used_.Multiplicity(j)});
    weight += shares.back().share;
  }
  for (const auto& [place, cell] : cells) AddRead(cell.first, cell.second);
}

void SceneReads::AddRead(const std::vector<Share>& shares, double weight) {
  double sum = 0;
  for (const Share& share : shares) sum += share.share;
  if (!(sum > 0)) return;
  const int begin = static_cast<int>(shares_.size());
  for (const auto& [sample, share] : shares) {
    if (share > 0) shares_.push_back({sample, share / sum});
  }
  reads_.push_back({begin, static_cast<int>(shares_.size()), weight});
}

SeenError SceneReads::Compare(const FactorModel& model, int num_threads) const {
  const std::vector<Rgb> fitted = EvaluateSamples(model, used_, num_threads);
  const std::vector<Rgb> measured = MeasuredLike(fitted, model, num_threads);
  std::vector<SeenPatch> patches;
  patches.reserve(reads_.size());
  for (const Read& read : reads_) {
    SeenPatch patch{.cosines = {0, 0}, .weight = read.weight};
    for (int k = read.begin; k < read.end; ++k) {
      const auto [j, share] = shares_[k];
      patch.cosines.i += share * cosines_[j].i;
      patch.cosines.o += share * cosines_[j].o;
      for (int c = 0; c < kChannels; ++c) {
        patch.measured[c] += share * measured[j][c];
        patch.fitted[c] += share * fitted[j][c];
      }
    }
    patches.push_back(patch);
  }
  return ComparePatches(patches);
}

}  // namespace trilobe
