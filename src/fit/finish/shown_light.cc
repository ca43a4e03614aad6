#include "fit/finish/shown_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/quantile.h"
#include "model/measurement/albedo_rule.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {
namespace {

// Which theta_h and theta_d are next to those of samples, in cells of equal width in the root of
// theta_h and in theta_d.
class MeasuredCells {
 public:
  explicit MeasuredCells(const BrdfSamples& samples) {
    for (const HalfDiffAngles& angles : samples.angles) {
      const int h = RowOf(angles), d = ColumnOf(angles);
      for (int a = std::max(h - 1, 0); a <= std::min(h + 1, kCells - 1); ++a) {
        for (int b = std::max(d - 1, 0); b <= std::min(d + 1, kCells - 1); ++b) {
          measured_[a][b] = true;
        }
      }
    }
  }

  bool operator()(const HalfDiffAngles& angles) const {
    return measured_[RowOf(angles)][ColumnOf(angles)];
  }

 private:
  static constexpr int kCells = 30;
  static int Cell(double share) {
    return std::clamp(static_cast<int>(kCells * share), 0, kCells - 1);
  }
  static int RowOf(const HalfDiffAngles& angles) {
    return Cell(std::sqrt(angles.theta_h / (kPi / 2)));
  }
  static int ColumnOf(const HalfDiffAngles& angles) { return Cell(angles.theta_d / (kPi / 2)); }

  std::array<std::array<bool, kCells>, kCells> measured_{};
};

// The middle of each range of theta, so many degrees wide, with enough samples. Light may come and
// go either way. The azimuth is that of one of them.
std::vector<PolarAngles> Incidences(const BrdfSamples& samples, int degrees) {
  constexpr int kEnough = 8;
  struct Near {
    int count = 0;
    double theta = 0, phi = 0;  // a sum; of the first
  };
  std::vector<Near> near(90 / degrees);
  const auto add = [&](double theta, double phi) {
    const int k = static_cast<int>(RadiansToDegrees(theta) / degrees);
    Near& at = near[std::clamp(k, 0, static_cast<int>(near.size()) - 1)];
    if (at.count == 0) at.phi = phi;
    ++at.count;
    at.theta += theta;
  };
  for (const SphericalAngles& at : samples.directions) {
    add(at.theta_i, at.phi_i);
    add(at.theta_o, at.phi_o);
  }
  std::vector<PolarAngles> incidences;
  for (const Near& at : near) {
    if (at.count >= kEnough) incidences.push_back({at.theta / at.count, at.phi});
  }
  return incidences;
}

// Light of a diffuse base as dark as the darkest sample; 0 where samples of a highlight alone do
// not tell one.
double DiffuseLight(const BrdfSamples& samples) {
  if (!ShowsMoreThanHighlight(samples)) return 0;
  double darkest = std::numeric_limits<double>::infinity();
  for (const Rgb& rho : samples.rho) darkest = std::min(darkest, std::ranges::max(rho));
  return kPi * darkest;
}

}  // namespace

bool ShowsMoreThanHighlight(const BrdfSamples& samples) {
  constexpr double kAway = DegreesToRadians(20);
  return std::ranges::any_of(samples.angles,
                             [](const HalfDiffAngles& at) { return at.theta_h > kAway; });
}

double ShownLight(const BrdfSamples& samples, const FactorModel& model, int num_threads) {
  constexpr int kAzimuths = 36;
  constexpr double kFarthest = DegreesToRadians(89.5);
  if (samples.directions.empty()) return 0;
  std::vector<PolarAngles> incidences = Incidences(samples, 1);
  if (incidences.empty()) incidences = Incidences(samples, 10);
  const MeasuredCells measured(samples);
  const PreparedModel<double> prepared(model);
  const double least_cosine = std::cos(LargestTheta(samples));
  std::vector<double> largest(incidences.size());
  ParallelFor(static_cast<int>(incidences.size()), num_threads, [&](int k) {
    const double theta = incidences[k].theta, phi = incidences[k].phi;
    Rgb light{};
    VisitReflected(
        std::min(theta, kFarthest), kAzimuths, [&](const DirectionPair& pair, double weight) {
          if (pair.wo[2] < least_cosine || !measured(ToHalfDiff(pair))) return;
          const Rgb value =
              prepared.Value(TurnedAboutNormal(pair.wi, phi), TurnedAboutNormal(pair.wo, phi));
          for (int c = 0; c < kChannels; ++c) light[c] += weight * value[c];
        });
    largest[k] = std::ranges::max(light) * 2 * kPi / kAzimuths;
  });
  const double diffuse = DiffuseLight(samples);
  return largest.empty() ? diffuse : std::max(diffuse, UpperMedian(std::move(largest)));
}

double LimitByShown(const BrdfSamples& samples, const FactorModel& model, int num_threads) {
  const double shown = ShownLight(samples, model, num_threads);
  if (!IsInOtherUnits(shown)) return std::max(1.0, shown);
  return (model.spec().anisotropic() ? 1 : 3) * kOfShown * shown;
}

}  // namespace trilobe
