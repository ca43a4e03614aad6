#include "trilobe/fit/finish/reach.h"

#include <algorithm>
#include <cmath>

#include "core/base/radical_inverse.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe {
namespace {

constexpr size_t kDirections = 50000;

// The largest channel of the model at each pair.
std::vector<double> LargestChannels(const std::vector<SphericalAngles>& pairs,
                                    const FactorModel& model, int num_threads) {
  BrdfSamples at;
  at.directions = pairs;
  for (const SphericalAngles& pair : pairs) at.angles.push_back(ToHalfDiff(ToDirections(pair)));
  at.rho.assign(pairs.size(), {});
  std::vector<double> largest;
  if (pairs.empty()) return largest;
  for (const Rgb& rho : EvaluateSamples(model, at, num_threads)) {
    largest.push_back(std::ranges::max(rho));
  }
  return largest;
}

}  // namespace

std::vector<SphericalAngles> DirectionsBetween(double max_theta, size_t count, Spread spread) {
  std::vector<SphericalAngles> pairs;
  const size_t tries = 20 * count;
  for (size_t k = 0; k < tries && pairs.size() < count; ++k) {
    const double u[] = {RadicalInverse(2, k + 1), RadicalInverse(3, k + 1),
                        RadicalInverse(5, k + 1), RadicalInverse(7, k + 1)};
    SphericalAngles at;
    if (spread == Spread::kByHighlights || k % 2 == 0) {
      const auto [wi, h] = ToDirections(SphericalAngles{max_theta * u[0], 2 * kPi * u[1],
                                                        max_theta * u[2] * u[2], 2 * kPi * u[3]});
      const double cosine = Dot(wi, h);
      Direction wo;
      for (int c = 0; c < 3; ++c) wo[c] = 2 * cosine * h[c] - wi[c];
      if (!(cosine > 0 && wo[2] > 0)) continue;
      at = ToSphericalAngles({wi, wo});
    } else {
      at = ToSphericalAngles(
          ToDirections(HalfDiffAngles{max_theta * u[2], max_theta * u[0] * u[0], kPi * u[1]}));
      at.phi_i += 2 * kPi * u[3];
      at.phi_o += 2 * kPi * u[3];
    }
    if (std::max(at.theta_i, at.theta_o) <= max_theta) pairs.push_back(at);
  }
  return pairs;
}

double LargestTheta(const BrdfSamples& samples) {
  double max_theta = 0;
  for (const SphericalAngles& at : samples.directions) {
    max_theta = std::max({max_theta, at.theta_i, at.theta_o});
  }
  return max_theta;
}

double LargestValue(const BrdfSamples& samples) {
  double largest = 0;
  for (const Rgb& rho : samples.rho) largest = std::max(largest, std::ranges::max(rho));
  return largest;
}

std::vector<SphericalAngles> DirectionsAbove(double value, double max_theta,
                                             const FactorModel& model, int num_threads) {
  const std::vector<SphericalAngles> pairs =
      DirectionsBetween(max_theta, kDirections, Spread::kRetroreflectionToo);
  const std::vector<double> largest = LargestChannels(pairs, model, num_threads);
  std::vector<SphericalAngles> above;
  for (size_t k = 0; k < pairs.size(); ++k) {
    if (largest[k] > value) above.push_back(pairs[k]);
  }
  return above;
}

Reach ReachOf(const BrdfSamples& samples, const FactorModel& model, int num_threads) {
  const double farthest = DegreesToRadians(89), measured = LargestValue(samples);
  Reach reach{.max_theta = LargestTheta(samples)};
  if (!(measured > 0)) return reach;
  for (const double max_theta : {reach.max_theta, farthest}) {
    const std::vector<SphericalAngles> pairs =
        DirectionsBetween(max_theta, kDirections, Spread::kRetroreflectionToo);
    const std::vector<double> largest = LargestChannels(pairs, model, num_threads);
    for (size_t k = 0; k < pairs.size(); ++k) {
      const bool within = std::max(pairs[k].theta_i, pairs[k].theta_o) <= reach.max_theta;
      double& reached = within ? reach.between : reach.beyond;
      reached = std::max(reached, largest[k] / measured);
    }
  }
  return reach;
}

}  // namespace trilobe
