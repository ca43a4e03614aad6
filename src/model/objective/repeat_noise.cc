#include "trilobe/model/objective/repeat_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "trilobe/core/base/angles.h"
#include "trilobe/model/objective/folded_grid.h"

namespace trilobe {
namespace {

// Angles of a sample in steps that are wide against rounding. Equal for the same directions and,
// for isotropic materials, for mirrored, turned and exchanged ones.
using Key = std::array<int64_t, 4>;

Key KeyOf(const BrdfSamples& samples, int j, bool anisotropic) {
  constexpr double kStep = 1e-6;  // [rad]
  const auto steps = [](double angle) { return std::llround(angle / kStep); };
  if (anisotropic) {
    const SphericalAngles& at = samples.directions[j];
    return {steps(at.theta_i), steps(at.phi_i), steps(at.theta_o), steps(at.phi_o)};
  }
  const HalfDiffAngles at = samples.Angles(j);
  // Along the normal and at the light, an azimuth says nothing.
  if (at.theta_h < kStep || at.theta_d < kStep) return {steps(at.theta_h), steps(at.theta_d)};
  double phi = std::abs(std::remainder(at.phi_d, kPi));  // up to a quarter turn
  return {steps(at.theta_h), steps(at.theta_d), steps(phi)};
}

// Nothing for what rounding leaves of equal values.
std::optional<RepeatNoise> UnlessRounding(const RepeatNoise& noise) {
  constexpr double kRounding = 1e-20;
  return noise.relative_objective > kRounding ? std::optional(noise) : std::nullopt;
}

}  // namespace

std::optional<RepeatNoise> NoiseOfRepeats(const Objective& data) {
  const BrdfSamples& samples = data.samples();
  if (data.on_grid()) {
    // Each bin has one with the directions exchanged, and a pair's variance is twice what remains
    // beside its mean. A model that stretches highlights has samples of its own, not this fold.
    double black = data.MeasuredEnergy(), left = data.IrreducibleEnergy();
    if (data.folded() == nullptr) {
      const FoldedGrid folded =
          Fold(samples, data.spec().g_axis.size, data.weighting(), data.num_threads());
      black = folded.measured_energy;
      left = folded.constant;
    }
    return UnlessRounding({samples.size(), black > 0 ? 2 * left / black : 0});
  }
  std::vector<Key> keys(samples.size());
  for (int j = 0; j < samples.size(); ++j) keys[j] = KeyOf(samples, j, data.spec().anisotropic());
  std::vector<int> order(samples.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int j) { return keys[j]; });
  RepeatNoise noise;
  double E = 0, black = 0;
  for (size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    for (end = begin + 1; end < order.size() && keys[order[end]] == keys[order[begin]];) ++end;
    const auto count = static_cast<double>(end - begin);
    if (end - begin < 2) continue;
    noise.samples += static_cast<int>(end - begin);
    for (int c = 0; c < kChannels; ++c) {
      double w = 0, mean = 0, squares = 0;
      for (size_t k = begin; k < end; ++k) {
        const WeightedSample sample = data.Sample(order[k]);
        const double more = sample.weight[c], rho = sample.rho[c];
        const double share = w + more > 0 ? more / (w + more) : 0, difference = rho - mean;
        squares += w * share * difference * difference;
        mean += share * difference;
        w += more;
        black += more * rho * rho;
      }
      E += squares * count / (count - 1);
    }
  }
  if (black > 0) noise.relative_objective = E / black;
  return UnlessRounding(noise);
}

}  // namespace trilobe
