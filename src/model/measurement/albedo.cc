#include "trilobe/model/measurement/albedo.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "model/measurement/albedo_rule.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

void AddScaled(const Rgb& value, double scale, Rgb* sum) {
  for (int c = 0; c < kChannels; ++c) (*sum)[c] += scale * value[c];
}

}  // namespace

Rgb DirectionalAlbedo(const BrdfFunction& brdf, double theta_i) {
  CheckNotEmpty(brdf, "brdf");
  if (!(theta_i >= 0 && theta_i < kPi / 2)) {
    throw Error(ErrorKind::kRange,
                "theta_i is " + std::to_string(theta_i) + "; it must be from 0 to below pi/2")
        .About("theta_i", theta_i);
  }
  Rgb albedo{};
  VisitReflected(theta_i, kAlbedoAzimuths, [&](const DirectionPair& pair, double weight) {
    AddScaled(brdf(pair), weight, &albedo);
  });
  Rgb result{};
  AddScaled(albedo, 2 * kPi / kAlbedoAzimuths, &result);
  return result;
}

std::vector<Rgb> DirectionalAlbedos(const BrdfFunction& brdf, std::span<const double> theta_i,
                                    int num_threads) {
  std::vector<Rgb> albedo(theta_i.size());
  ParallelFor(static_cast<int>(theta_i.size()), num_threads,
              [&](int i) { albedo[i] = DirectionalAlbedo(brdf, theta_i[i]); });
  return albedo;
}

std::optional<double> AlbedoPassesOne(std::span<const double> theta_i, std::span<const Rgb> albedo,
                                      int channel) {
  if (theta_i.size() != albedo.size() || channel < 0 || channel >= kChannels) {
    throw Error(ErrorKind::kMismatch,
                "each angle needs an albedo of channel 0, 1 or 2; there are " +
                    std::to_string(theta_i.size()) + " angles, " + std::to_string(albedo.size()) +
                    " albedos, and channel " + std::to_string(channel))
        .About("albedo", albedo.size());
  }
  for (size_t i = 0; i < albedo.size(); ++i) {
    const double here = albedo[i][channel];
    if (!(here > 1)) continue;
    if (i == 0) return theta_i[0];
    const double before = albedo[i - 1][channel];
    return theta_i[i - 1] + (1 - before) / (here - before) * (theta_i[i] - theta_i[i - 1]);
  }
  return std::nullopt;
}

}  // namespace trilobe
