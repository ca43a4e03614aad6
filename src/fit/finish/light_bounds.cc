#include "fit/finish/light_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "fit/finish/albedos_of.h"
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

// Turns directions about the normal by one azimuth.
class Turn {
 public:
  explicit Turn(double phi) : cos_(std::cos(phi)), sin_(std::sin(phi)) {}

  Direction operator()(const Direction& w) const {
    return {cos_ * w[0] - sin_ * w[1], sin_ * w[0] + cos_ * w[1], w[2]};
  }

 private:
  double cos_, sin_;
};

// An albedo by few azimuths of half vectors.
Rgb QuickAlbedo(const PreparedModel<double>& prepared, bool anisotropic, const PolarAngles& at) {
  if (!anisotropic) return AlbedoOf(prepared, at.theta, kQuickAzimuths);
  const Turn turned(at.phi);
  Rgb albedo{};
  VisitReflected(at.theta, kQuickAzimuths, [&](const DirectionPair& pair, double weight) {
    const Rgb value = prepared.Value(turned(pair.wi), turned(pair.wo));
    for (int c = 0; c < kChannels; ++c) albedo[c] += weight * value[c];
  });
  for (double& x : albedo) x *= 2 * kPi / kQuickAzimuths;
  return albedo;
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
    const Turn turned(at.phi);
    std::vector<Rgb> values(lobes), sum(lobes);
    VisitReflected(at.theta, kQuickAzimuths, [&](const DirectionPair& pair, double weight) {
      prepared.LobeValues(turned(pair.wi), turned(pair.wo), values.data());
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

// A direction that is looked at, and what a lobe at a time says that it reflects.
struct Looked {
  PolarAngles at;
  Rgb albedo;
};

std::vector<Looked> LookByLobes(const FactorModel& model, int num_threads) {
  const LobesByShadowing lobes(model, num_threads);
  std::vector<Looked> looked;
  for (int k = 0; k < kLookedThetas; ++k) {
    for (int b = 0; b < kLookedAzimuths; ++b) {
      const PolarAngles at = {LookedTheta(k), LookedAzimuth(b)};
      looked.push_back({at, lobes.Albedo(at)});
    }
  }
  return looked;
}

std::vector<PolarAngles> AllThetas() {
  std::vector<PolarAngles> all;
  for (int k = 0; k < kLookedThetas; ++k) all.push_back({LookedTheta(k), 0});
  return all;
}

}  // namespace

std::vector<Rgb> AlbedosFrom(const std::vector<LightBound>& bounds, const FactorModel& model,
                             int num_threads) {
  const PreparedModel<double> prepared(model);
  std::vector<Rgb> albedos(bounds.size());
  ParallelFor(static_cast<int>(bounds.size()), num_threads, [&](int k) {
    const double theta = bounds[k].at.theta, phi = bounds[k].at.phi;
    if (!model.spec().anisotropic()) {
      albedos[k] = AlbedoOf(prepared, theta);
      return;
    }
    const Turn turned(phi);
    albedos[k] = DirectionalAlbedo(
        [&](const DirectionPair& pair) {
          return phi == 0 ? prepared.Value(pair.wi, pair.wo)
                          : prepared.Value(turned(pair.wi), turned(pair.wo));
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

std::vector<size_t> MayExceed(const std::vector<LightBound>& bounds, double by,
                              const FactorModel& model, int num_threads) {
  constexpr double kQuickError = 0.02;
  const PreparedModel<double> prepared(model);
  const bool anisotropic = model.spec().anisotropic();
  std::vector<Rgb> quick(bounds.size());
  ParallelFor(static_cast<int>(bounds.size()), num_threads,
              [&](int k) { quick[k] = QuickAlbedo(prepared, anisotropic, bounds[k].at); });
  std::vector<size_t> near;
  for (size_t k = 0; k < bounds.size(); ++k) {
    if (ExcessOf(quick[k], bounds[k].limit) > (1 - kQuickError) * by) near.push_back(k);
  }
  return near;
}

std::vector<LightBound> ExceededBounds(const Rgb& limit, const FactorModel& model,
                                       int num_threads) {
  constexpr double kNearByLobes = 0.95;
  constexpr size_t kMost = 180;  // of which each is costly
  constexpr size_t kParts = 3;
  const auto exceeded_of = [&](const std::vector<LightBound>& some) {
    std::vector<LightBound> near, exceeded;
    for (const size_t k : MayExceed(some, 1, model, num_threads)) near.push_back(some[k]);
    const std::vector<Rgb> albedos = AlbedosFrom(near, model, num_threads);
    for (size_t k = 0; k < near.size(); ++k) {
      if (ExcessOf(albedos[k], limit) > 1 + kLightTolerance) exceeded.push_back(near[k]);
    }
    return exceeded;
  };
  std::vector<Looked> near_by_lobes;
  if (model.spec().anisotropic()) {
    near_by_lobes = LookByLobes(model, num_threads);
    std::erase_if(near_by_lobes, [&](const Looked& looked) {
      return !(ExcessOf(looked.albedo, limit) > kNearByLobes);
    });
  } else {
    for (const PolarAngles& at : AllThetas()) near_by_lobes.push_back({at, {}});
  }
  const size_t parts = (near_by_lobes.size() + kMost - 1) / kMost;
  for (size_t part = 0; part < std::min(parts, kParts); ++part) {
    std::vector<LightBound> some;
    for (size_t k = part; k < near_by_lobes.size(); k += parts) {
      some.push_back({near_by_lobes[k].at, limit});
    }
    std::vector<LightBound> exceeded = exceeded_of(some);
    if (!exceeded.empty()) return exceeded;
  }
  if (parts <= kParts) return {};
  std::ranges::stable_sort(near_by_lobes, std::ranges::greater(),
                           [&](const Looked& looked) { return ExcessOf(looked.albedo, limit); });
  std::vector<LightBound> largest;
  for (size_t k = 0; k < kMost; ++k) largest.push_back({near_by_lobes[k].at, limit});
  return exceeded_of(largest);
}

PeakAlbedo PeakOfLookedAt(const FactorModel& model, int num_threads) {
  constexpr int kLargest = 24;
  std::vector<Looked> looked = LookByLobes(model, num_threads);
  std::ranges::stable_sort(looked, std::ranges::greater(),
                           [](const Looked& x) { return std::ranges::max(x.albedo); });
  std::vector<LightBound> largest;
  for (int k = 0; k < kLargest; ++k) largest.push_back({looked[k].at, {}});
  const std::vector<Rgb> albedos = AlbedosFrom(largest, model, num_threads);
  PeakAlbedo peak;
  for (size_t k = 0; k < largest.size(); ++k) {
    const double here = std::ranges::max(albedos[k]);
    if (here > peak.albedo) peak = {.albedo = here, .theta_i = largest[k].at.theta};
  }
  return peak;
}

}  // namespace trilobe
