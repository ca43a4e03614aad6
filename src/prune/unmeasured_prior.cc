#include "prune/unmeasured_prior.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "trilobe/brdf/brdf_table.h"
#include "trilobe/lobes/reconstruct.h"

namespace trilobe {
namespace {

constexpr double kWeight = 0.01;  // of what it says of a bin, where a measured one counts 1
// Said for so many bins, but by so many samples at least of each theta_h, theta_d, theta_i and
// theta_o.
constexpr int kStride = 32, kLeast = 64;
constexpr double kAbsurd = 100;    // times the largest value that was measured
constexpr double kLargest = 1e50;  // that an objective takes

}  // namespace

UnmeasuredPrior::UnmeasuredPrior(const Objective& objective, const FactorModel& model)
    : said_{objective.samples().source, objective.samples().grid, {}, {}, {}} {
  const BrdfSamples& measured = objective.samples();
  if (!measured.on_grid()) return;
  std::vector<bool> open = BinsAboveSurface(measured.grid);
  for (const int bin : measured.bins) open[bin] = false;
  for (int bin = 0; bin < measured.grid.size(); ++bin) {
    if (open[bin]) said_.bins.push_back(bin);
  }
  if (said_.bins.empty()) return;
  said_.rho.assign(said_.bins.size(), {});
  said_.rho = UnclampedSamples(model, said_, objective.num_threads());
  Rgb most{};
  for (const Rgb& rho : measured.rho) {
    for (int c = 0; c < kChannels; ++c) most[c] = std::max(most[c], rho[c]);
  }
  std::vector<int> finite;
  for (int j = 0; j < said_.size(); ++j) {
    Rgb& rho = said_.rho[j];
    if (!std::ranges::all_of(rho, [](double x) { return std::isfinite(x); })) continue;
    finite.push_back(j);
    // A spline may undershoot, and a model be absurd.
    for (int c = 0; c < kChannels; ++c) {
      rho[c] = std::clamp(rho[c], 0.0, std::min(kAbsurd * most[c], kLargest));
    }
  }
  said_ = ThinnedByPlace(Selected(said_, finite), kStride, kLeast);
  for (double& times : said_.multiplicity) times *= kWeight;
}

Objective UnmeasuredPrior::With(const Objective& objective) const {
  if (said_.rho.empty()) return objective;
  const BrdfSamples& measured = objective.samples();
  BrdfSamples both{measured.source, measured.grid, {}, {}, {}};
  for (int j = 0, k = 0; j < measured.size() || k < said_.size();) {
    const bool own = k == said_.size() || (j < measured.size() && measured.bins[j] < said_.bins[k]);
    const BrdfSamples& from = own ? measured : said_;
    const int number = own ? j++ : k++;
    both.bins.push_back(from.bins[number]);
    both.rho.push_back(from.rho[number]);
    both.multiplicity.push_back(from.Multiplicity(number));
  }
  return {std::move(both), objective.spec(), objective.weighting(), objective.num_threads()};
}

}  // namespace trilobe
