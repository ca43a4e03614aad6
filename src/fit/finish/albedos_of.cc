#include "fit/finish/albedos_of.h"

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {

Rgb AlbedoOf(const PreparedModel<double>& prepared, double theta_i, int azimuths) {
  Rgb albedo{};
  VisitReflected(
      theta_i, azimuths,
      [&](const DirectionPair& pair, double weight) {
        const Rgb value = prepared.Value(pair.wi, pair.wo);
        for (int c = 0; c < kChannels; ++c) albedo[c] += weight * value[c];
      },
      Side::kOne);
  for (double& x : albedo) x *= 2 * 2 * kPi / azimuths;
  return albedo;
}

std::vector<Rgb> AlbedosOf(const FactorModel& model, std::span<const double> theta_i,
                           int num_threads) {
  const PreparedModel<double> prepared(model);
  std::vector<Rgb> albedos(theta_i.size());
  ParallelFor(static_cast<int>(theta_i.size()), num_threads,
              [&](int k) { albedos[k] = AlbedoOf(prepared, theta_i[k]); });
  return albedos;
}

}  // namespace trilobe
