#include "trilobe/model/appearance/sampled_sphere.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/appearance/view.h"

namespace trilobe {
namespace {

constexpr int kThetas = 12, kAzimuths = 24;

struct CellSums {
  int samples = 0;
  Rgb measured{}, fitted{};
};

class SampleCells {
 public:
  SampleCells(const BrdfSamples& samples, const std::vector<Rgb>& values, bool by_azimuth)
      : by_azimuth_(by_azimuth),
        cells_(kThetas * kThetas * kAzimuths * (by_azimuth ? kAzimuths : 1)) {
    for (int j = 0; j < samples.size(); ++j) {
      const SphericalAngles at = samples.directions.empty()
                                     ? ToSphericalAngles(ToDirections(samples.Angles(j)))
                                     : samples.directions[j];
      CellSums& cell = cells_[IndexOf(at)];
      ++cell.samples;
      for (int c = 0; c < kChannels; ++c) {
        cell.measured[c] += samples.rho[j][c];
        cell.fitted[c] += std::max(values[j][c], 0.0);
      }
    }
  }

  const CellSums& operator()(const SphericalAngles& at) const { return cells_[IndexOf(at)]; }

 private:
  static int Part(double share, int parts) {
    return std::clamp(static_cast<int>(share * parts), 0, parts - 1);
  }
  static double Turns(double phi) { return phi / (2 * kPi) - std::floor(phi / (2 * kPi)); }

  int IndexOf(const SphericalAngles& at) const {
    int i = Part(at.theta_i / (kPi / 2), kThetas), o = Part(at.theta_o / (kPi / 2), kThetas);
    if (by_azimuth_) {
      return ((i * kThetas + o) * kAzimuths + Part(Turns(at.phi_i), kAzimuths)) * kAzimuths +
             Part(Turns(at.phi_o), kAzimuths);
    }
    if (i > o) std::swap(i, o);
    const double between = std::abs(std::remainder(at.phi_i - at.phi_o, 2 * kPi));
    return (i * kThetas + o) * kAzimuths + Part(between / (2 * kPi), kAzimuths);
  }

  const bool by_azimuth_;
  std::vector<CellSums> cells_;
};

Rgb Corrected(Rgb fitted, const CellSums& cell) {
  for (int c = 0; c < kChannels; ++c) {
    fitted[c] = cell.fitted[c] > 0 ? fitted[c] * (cell.measured[c] / cell.fitted[c])
                                   : cell.measured[c] / std::max(cell.samples, 1);
  }
  return fitted;
}

}  // namespace

SeenError CompareSampledSphere(const BrdfSamples& samples, const std::vector<Rgb>& values,
                               const SphericalBrdf& fitted, bool by_azimuth,
                               const AppearanceOptions& options) {
  constexpr int kEvery = 4;  // tells the same as all pixels would
  CheckSize("values", values.size(), samples.rho.size());
  CheckNotEmpty(fitted, "the material");
  const SampleCells cells(samples, values, by_azimuth);
  const auto seen = [&](const SphericalAngles& at) {
    Rgb rho = fitted(at);
    for (double& x : rho) x = std::max(x, 0.0);
    return rho;
  };
  const SphericalBrdf materials[] = {
      [&](const SphericalAngles& at) { return Corrected(seen(at), cells(at)); }, seen};
  const View view = ViewSphere(options.size, kEvery);
  const RenderedImages images = Render(
      view, materials, DrawLights(EnvironmentOf(options), options.lights),
      [&](const SphericalAngles& at) { return cells(at).samples > 0; }, /*whole_too=*/false,
      options.num_threads);
  const auto reached = static_cast<size_t>(std::ranges::count_if(
      images.counted[0].coverage, [](double coverage) { return coverage > 0; }));
  if (reached < view.points.size() / 2) return CompareSamples(samples, values);
  return CompareSpheres(images.counted[0], images.counted[1]);
}

}  // namespace trilobe
