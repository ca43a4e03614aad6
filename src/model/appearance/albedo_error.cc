#include "trilobe/model/appearance/albedo_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "trilobe/core/base/check.h"

namespace trilobe {
namespace {

Direction Turned(const Direction& w, double cos_phi, double sin_phi) {
  return {cos_phi * w[0] - sin_phi * w[1], sin_phi * w[0] + cos_phi * w[1], w[2]};
}

// A rotated BRDF: azimuth 0 of the result is azimuth `phi` [rad] of `brdf`.
BrdfFunction TurnedTo(double phi, const BrdfFunction& brdf) {
  if (phi == 0) return brdf;
  return [&brdf, c = std::cos(phi), s = std::sin(phi)](const DirectionPair& pair) {
    return brdf({Turned(pair.wi, c, s), Turned(pair.wo, c, s)});
  };
}

}  // namespace

AlbedoError CompareAlbedos(const BrdfFunction& measured, const BrdfFunction& fitted,
                           std::span<const double> phi_i, int num_threads) {
  CheckNotEmpty(measured, "measured");
  CheckNotEmpty(fitted, "fitted");
  std::vector<double> thetas;
  for (const int degrees : {0, 15, 30, 45, 60, 75}) thetas.push_back(DegreesToRadians(degrees));
  AlbedoError error;
  for (const double phi : phi_i) {
    error.theta_i.insert(error.theta_i.end(), thetas.begin(), thetas.end());
    error.phi_i.insert(error.phi_i.end(), thetas.size(), phi);
    const auto add = [&](const BrdfFunction& brdf, std::vector<Rgb>* albedos) {
      std::ranges::copy(DirectionalAlbedos(TurnedTo(phi, brdf), thetas, num_threads),
                        std::back_inserter(*albedos));
    };
    add(measured, &error.measured);
    add(fitted, &error.fitted);
  }
  for (size_t k = 0; k < error.theta_i.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) {
      const double difference = std::abs(error.fitted[k][c] - error.measured[k][c]);
      error.mean += difference / static_cast<double>(kChannels * error.theta_i.size());
      error.max = std::max(error.max, difference);
    }
  }
  return error;
}

}  // namespace trilobe
