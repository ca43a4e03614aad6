#include "fit/finish/light_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "model/measurement/albedo_rule.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/stencil.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {
namespace {

constexpr int kLookedThetas = 180, kLookedAzimuths = 72;
constexpr int kQuickAzimuths = 36;  // of half vectors

double LookedTheta(int k) { return DegreesToRadians(0.5 * k); }
double LookedAzimuth(int b) { return 2 * kPi * b / kLookedAzimuths; }

// The albedo of an isotropic model by half of few azimuths, as one half mirrors the other.
Rgb QuickAlbedo(const PreparedModel<double>& prepared, double theta) {
  Rgb albedo{};
  VisitReflected(theta, kQuickAzimuths, [&](const DirectionPair& pair, double weight) {
    if (pair.wo[1] < 0) return;
    const Rgb value = prepared.Value(pair.wi, pair.wo);
    for (int c = 0; c < kChannels; ++c) albedo[c] += 2 * weight * value[c];
  });
  for (double& x : albedo) x *= 2 * kPi / kQuickAzimuths;
  return albedo;
}

std::vector<LightBound> NearIsotropic(double share, const Rgb& limit, const FactorModel& model,
                                      int num_threads) {
  const PreparedModel<double> prepared(model);
  std::array<Rgb, kLookedThetas> albedos{};
  ParallelFor(kLookedThetas, num_threads,
              [&](int k) { albedos[k] = QuickAlbedo(prepared, LookedTheta(k)); });
  std::vector<LightBound> near;
  for (int k = 0; k < kLookedThetas; ++k) {
    const LightBound bound = {{LookedTheta(k), 0}, limit};
    if (ExcessOf(albedos[k], bound.limit) > share) near.push_back(bound);
  }
  return near;
}

// G_m(theta, phi) / cos theta, of each lobe and channel.
double ShadowingAt(const FactorModel& model, const PolarAngles& at, int lobe, int channel) {
  return model.spec().g_axis.At(at.theta, at.phi)(model.G(lobe, channel)) / std::cos(at.theta);
}

// K_m, linear between the directions where it is computed. Near the horizon these have all azimuths
// that are looked at, as a highlight there is narrow.
class LobesByShadowing {
 public:
  LobesByShadowing(const FactorModel& model, int num_threads) : model_(model) {
    std::vector<PolarAngles> knots;
    for (const Ring& ring : kRings) {
      for (int b = 0; b < ring.turns; ++b) {
        knots.push_back({DegreesToRadians(ring.degrees), 2 * kPi * b / ring.turns});
      }
    }
    const PreparedModel<double> prepared(model);
    K_.resize(knots.size());
    ParallelFor(static_cast<int>(knots.size()), num_threads,
                [&](int k) { K_[k] = AtKnot(prepared, knots[k]); });
  }

  Rgb Albedo(const PolarAngles& at) const {
    const double degrees = RadiansToDegrees(at.theta);
    int ring = 1, begin = 0;
    while (ring + 1 < std::ssize(kRings) && kRings[ring].degrees < degrees) {
      begin += kRings[ring - 1].turns;
      ++ring;
    }
    const Ring &before = kRings[ring - 1], &after = kRings[ring];
    const double t = (degrees - before.degrees) / (after.degrees - before.degrees);
    Rgb albedo{};
    for (int c = 0; c < kChannels; ++c) {
      albedo[c] = kPi * model_.d()[c];
      for (int m = 0; m < model_.spec().lobes; ++m) {
        const double K = (1 - t) * Around(begin, before.turns, at.phi, m, c) +
                         t * Around(begin + before.turns, after.turns, at.phi, m, c);
        albedo[c] += K * ShadowingAt(model_, at, m, c);
      }
    }
    return albedo;
  }

 private:
  struct Ring {
    double degrees;
    int turns;
  };
  static constexpr Ring kRings[] = {{0, 6},
                                    {50, 6},
                                    {75, 24},
                                    {80, 24},
                                    {84, kLookedAzimuths},
                                    {87, kLookedAzimuths},
                                    {89.5, kLookedAzimuths}};

  std::vector<Rgb> AtKnot(const PreparedModel<double>& prepared, const PolarAngles& at) const {
    const int lobes = model_.spec().lobes;
    std::vector<Rgb> values(lobes), sum(lobes);
    VisitReflected(at.theta, kQuickAzimuths, [&](const DirectionPair& pair, double weight) {
      prepared.LobeValues(TurnedAboutNormal(pair.wi, at.phi), TurnedAboutNormal(pair.wo, at.phi),
                          values.data());
      for (int m = 0; m < lobes; ++m) {
        for (int c = 0; c < kChannels; ++c) sum[m][c] += weight * values[m][c];
      }
    });
    for (int m = 0; m < lobes; ++m) {
      for (int c = 0; c < kChannels; ++c) {
        const double G = ShadowingAt(model_, at, m, c);
        sum[m][c] = G > 0 ? sum[m][c] * 2 * kPi / kQuickAzimuths / G : 0;
      }
    }
    return sum;
  }

  double Around(int begin, int turns, double phi, int m, int c) const {
    const double place = phi / (2 * kPi) * turns, left = std::floor(place), u = place - left;
    const int b = static_cast<int>(left) % turns;
    return (1 - u) * K_[begin + b][m][c] + u * K_[begin + (b + 1) % turns][m][c];
  }

  const FactorModel& model_;
  std::vector<std::vector<Rgb>> K_;  // [knots, ring by ring][lobes]
};

std::vector<LightBound> NearAnisotropic(double share, const Rgb& limit, const FactorModel& model,
                                        int num_threads) {
  const LobesByShadowing lobes(model, num_threads);
  std::vector<LightBound> near;
  for (int k = 0; k < kLookedThetas; ++k) {
    for (int b = 0; b < kLookedAzimuths; ++b) {
      const LightBound bound = {{LookedTheta(k), LookedAzimuth(b)}, limit};
      if (ExcessOf(lobes.Albedo(bound.at), limit) > share) near.push_back(bound);
    }
  }
  return near;
}

}  // namespace

std::vector<Rgb> AlbedosFrom(const std::vector<LightBound>& bounds, const FactorModel& model,
                             int num_threads) {
  const PreparedModel<double> prepared(model);
  std::vector<Rgb> albedos(bounds.size());
  ParallelFor(static_cast<int>(bounds.size()), num_threads, [&](int k) {
    const double theta = bounds[k].at.theta, phi = bounds[k].at.phi;
    albedos[k] = DirectionalAlbedo(
        [&](const DirectionPair& pair) {
          return phi == 0 ? prepared.Value(pair.wi, pair.wo)
                          : prepared.Value(TurnedAboutNormal(pair.wi, phi),
                                           TurnedAboutNormal(pair.wo, phi));
        },
        theta);
  });
  return albedos;
}

double ExcessOf(const Rgb& albedo, const Rgb& limit) {
  double excess = 0;
  for (int c = 0; c < kChannels; ++c) excess = std::max(excess, albedo[c] / limit[c]);
  return excess;
}

std::vector<LightBound> ExceededBounds(const Rgb& limit, const FactorModel& model,
                                       int num_threads) {
  constexpr double kNear = 0.98, kNearByLobes = 0.95;  // what a quick look may be off by
  const std::vector<LightBound> near =
      model.spec().anisotropic() ? NearAnisotropic(kNearByLobes, limit, model, num_threads)
                                 : NearIsotropic(kNear, limit, model, num_threads);
  const std::vector<Rgb> albedos = AlbedosFrom(near, model, num_threads);
  std::vector<LightBound> exceeded;
  for (size_t k = 0; k < near.size(); ++k) {
    if (ExcessOf(albedos[k], near[k].limit) > 1 + kLightTolerance) exceeded.push_back(near[k]);
  }
  return exceeded;
}

}  // namespace trilobe
