#include "fit/prune/unmeasured_prior.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe {
namespace {

// Weight of its value at a bin, where a measured one counts 1; and at directions beyond samples on
// no grid, where 0.01 costs 1.5 dB where data are (docs/decisions/forms.md).
constexpr double kWeight = 0.01, kWeightOfScattered = 0.001;
// One bin in kStride gets a value, but about kLeast at least for each theta_h, theta_d, theta_i and
// theta_o.
constexpr int kStride = 32, kLeast = 64;
constexpr double kAbsurd = 100;    // times the largest value that was measured
constexpr double kLargest = 1e50;  // that an objective takes

std::vector<int> OpenBins(const BrdfSamples& measured) {
  std::vector<bool> open = BinsAboveSurface(measured.grid);
  for (const int bin : measured.bins) open[bin] = false;
  std::vector<int> bins;
  for (int bin = 0; bin < measured.grid.size(); ++bin) {
    if (open[bin]) bins.push_back(bin);
  }
  return bins;
}

// Pairs farther from the normal than any that was measured, as dense as these.
std::vector<SphericalAngles> DirectionsBeyond(const BrdfSamples& measured) {
  constexpr double kFarthest = DegreesToRadians(89);
  std::vector<SphericalAngles> pairs =
      DirectionsBetween(kFarthest, measured.directions.size(), Spread::kRetroreflectionToo);
  std::erase_if(pairs, [largest = LargestTheta(measured)](const SphericalAngles& at) {
    return std::max(at.theta_i, at.theta_o) <= largest;
  });
  return pairs;
}

// Appends scattered samples.
BrdfSamples JoinSamples(BrdfSamples samples, const BrdfSamples& added) {
  const auto append = [](const auto& from, auto* target) {
    target->insert(target->end(), from.begin(), from.end());
  };
  samples.multiplicity.resize(samples.rho.size(), 1);
  append(added.multiplicity, &samples.multiplicity);
  append(added.angles, &samples.angles);
  append(added.directions, &samples.directions);
  append(added.rho, &samples.rho);
  return samples;
}

}  // namespace

UnmeasuredPrior::UnmeasuredPrior(const Objective& objective, const FactorModel& model)
    : samples_{objective.samples().source, objective.samples().grid, {}, {}, {}} {
  const BrdfSamples& measured = objective.samples();
  if (measured.on_grid()) {
    samples_.bins = OpenBins(measured);
  } else {
    samples_.directions = DirectionsBeyond(measured);
    for (const SphericalAngles& at : samples_.directions) {
      samples_.angles.push_back(ToHalfDiff(ToDirections(at)));
    }
  }
  const size_t places = samples_.bins.size() + samples_.angles.size();
  if (places == 0) return;
  samples_.rho.assign(places, {});
  samples_.rho = UnclampedSamples(model, samples_, objective.num_threads());
  Rgb most{};
  for (const Rgb& rho : measured.rho) {
    for (int c = 0; c < kChannels; ++c) most[c] = std::max(most[c], rho[c]);
  }
  std::vector<int> finite;
  for (int j = 0; j < samples_.size(); ++j) {
    Rgb& rho = samples_.rho[j];
    if (!std::ranges::all_of(rho, [](double x) { return std::isfinite(x); })) continue;
    finite.push_back(j);
    // A spline may undershoot, and a model be absurd.
    for (int c = 0; c < kChannels; ++c) {
      rho[c] = std::clamp(rho[c], 0.0, std::min(kAbsurd * most[c], kLargest));
    }
  }
  samples_ = ThinnedByPlace(Selected(samples_, finite), kStride, kLeast);
  const double weight = measured.on_grid() ? kWeight : kWeightOfScattered;
  for (double& times : samples_.multiplicity) times *= weight;
}

Objective UnmeasuredPrior::JoinTo(const Objective& objective) const {
  if (samples_.rho.empty()) return objective;
  const BrdfSamples& measured = objective.samples();
  if (!measured.on_grid()) {
    BrdfSamples both = JoinSamples(measured, samples_);
    return {std::move(both), objective.spec(), objective.weighting(), objective.num_threads()};
  }
  BrdfSamples both{measured.source, measured.grid, {}, {}, {}};
  both.counted = measured.counted;
  for (int j = 0, k = 0; j < measured.size() || k < samples_.size();) {
    const bool own =
        k == samples_.size() || (j < measured.size() && measured.bins[j] < samples_.bins[k]);
    const BrdfSamples& from = own ? measured : samples_;
    const int number = own ? j++ : k++;
    both.bins.push_back(from.bins[number]);
    both.rho.push_back(from.rho[number]);
    both.multiplicity.push_back(from.Multiplicity(number));
  }
  return {std::move(both), objective.spec(), objective.weighting(), objective.num_threads()};
}

}  // namespace trilobe
