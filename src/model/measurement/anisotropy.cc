#include "model/measurement/anisotropy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

namespace trilobe {
namespace {

// Samples that are neighbours in azimuth: of at least so many turns, at most so far apart [rad].
constexpr size_t kFewestTurns = 4;
constexpr double kMaxStep = kPi / 12 + 1e-6;

struct TurnedSample {
  std::array<int64_t, 3> key;  // theta_i, theta_o, phi_o - phi_i from 0 to 2 pi [1e-6 rad]
  double phi_i;                // from 0 to 2 pi
  int sample;
};

TurnedSample KeyOf(const SphericalAngles& at, int sample) {
  constexpr double kUnit = 1e-6;
  const auto whole_turn = static_cast<int64_t>(std::llround(2 * kPi / kUnit));
  const double turns = (at.phi_o - at.phi_i) / (2 * kPi);
  const int64_t between = std::llround((turns - std::floor(turns)) * 2 * kPi / kUnit);
  return {{std::llround(at.theta_i / kUnit), std::llround(at.theta_o / kUnit),
           between == whole_turn ? 0 : between},
          at.phi_i - 2 * kPi * std::floor(at.phi_i / (2 * kPi)),
          sample};
}

}  // namespace

Anisotropy AnisotropyOf(const Measurement& scattered) {
  CheckDirections(scattered);
  const std::vector<Rgb>& rho = scattered.samples.rho;
  std::vector<TurnedSample> keys;
  for (int j = 0; j < scattered.samples.size(); ++j) {
    keys.push_back(KeyOf(scattered.samples.directions[j], j));
  }
  std::ranges::stable_sort(keys, [](const TurnedSample& a, const TurnedSample& b) {
    return std::tie(a.key, a.phi_i) < std::tie(b.key, b.phi_i);
  });
  // Scaled to a largest value of 1, so that squares neither vanish nor overflow.
  double largest = std::numeric_limits<double>::min();
  for (const Rgb& values : rho) largest = std::max({largest, values[0], values[1], values[2]});
  Anisotropy anisotropy;
  double energy = 0, changing = 0;
  double smooth = 0, smooth_energy = 0, smooth_variance = 0;
  for (size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    Rgb mean{};
    for (; end < keys.size() && keys[end].key == keys[begin].key; ++end) {
      const auto count = static_cast<double>(end - begin + 1);
      for (int c = 0; c < kChannels; ++c) {
        mean[c] += (rho[keys[end].sample][c] / largest - mean[c]) / count;
      }
    }
    if (end - begin == 1) continue;
    const SphericalAngles& at = scattered.samples.directions[keys[begin].sample];
    const double cosines = std::cos(at.theta_i) * std::cos(at.theta_o);
    for (size_t k = begin; k < end; ++k) {
      for (int c = 0; c < kChannels; ++c) {
        const double x = rho[keys[k].sample][c] / largest;
        energy += cosines * cosines * x * x;
        changing += cosines * cosines * (x - mean[c]) * (x - mean[c]);
      }
    }
    anisotropy.samples += static_cast<int>(end - begin);
    // Each sample with the next azimuth, the last with the first.
    for (size_t k = begin; k < end; ++k) {
      const TurnedSample &one = keys[k], &next = keys[k + 1 < end ? k + 1 : begin];
      const double step = next.phi_i - one.phi_i + (k + 1 < end ? 0 : 2 * kPi);
      if (end - begin < kFewestTurns || step > kMaxStep) continue;
      double product = 0;
      for (int c = 0; c < kChannels; ++c) {
        const double x = rho[one.sample][c] / largest, y = rho[next.sample][c] / largest;
        product += cosines * cosines * (x - mean[c]) * (y - mean[c]);
        smooth_energy += cosines * cosines * x * x;
      }
      smooth += product;
      smooth_variance += product * product;
      ++anisotropy.with_neighbours;
    }
  }
  anisotropy.share = energy > 0 ? changing / energy : 0;
  if (smooth_energy > 0) {
    anisotropy.smooth_share = smooth / smooth_energy;
    anisotropy.smooth_share_error = 4 * std::sqrt(smooth_variance) / smooth_energy;
  }
  return anisotropy;
}

}  // namespace trilobe
