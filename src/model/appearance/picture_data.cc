#include "model/appearance/picture_data.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

constexpr MerlGrid kGrids[] = {{.theta_h = 90, .theta_d = 30, .phi_d = 36},
                               {.theta_h = 60, .theta_d = 18, .phi_d = 24},
                               {.theta_h = 45, .theta_d = 15, .phi_d = 18},
                               {.theta_h = 30, .theta_d = 12, .phi_d = 12}};
constexpr int kSamplesOfBin = 4;  // for each bin above the surface
constexpr double kFilled = 0.6;   // of these; what is next to a gap would fill it

constexpr int64_t kMostNodes = 3162;  // as of ParseHemisphereGrid

// Number of equal steps of a range whose ends these angles, in [0, range), are; 0 if there is only
// one.
int StepsOf(std::vector<double> angles, double range) {
  constexpr double kSame = 1e-6;  // [rad]
  std::ranges::sort(angles);
  double step = range;
  for (size_t k = 1; k < angles.size(); ++k) {
    const double between = angles[k] - angles[k - 1];
    if (between > kSame) step = std::min(step, between);
  }
  return step < range ? static_cast<int>(std::lround(std::min(range / step, 1e6))) : 0;
}

}  // namespace

std::optional<BrdfTable> TableOfSamples(const Measurement& scattered) {
  if (scattered.anisotropic) return std::nullopt;
  const BrdfSamples& samples = scattered.samples;
  for (const MerlGrid& grid : kGrids) {
    const std::vector<bool> above = BinsAboveSurface(grid);
    const auto bins = std::ranges::count(above, true);
    if (samples.size() < kSamplesOfBin * bins) continue;
    std::vector<Rgb> sums(grid.size());
    std::vector<int> counts(grid.size());
    for (int j = 0; j < samples.size(); ++j) {
      const int bin = grid.Bin(samples.Angles(j));
      ++counts[bin];
      for (int c = 0; c < kChannels; ++c) sums[bin][c] += samples.rho[j][c];
    }
    int filled = 0;
    BrdfTable table = MakeInvalidTable(scattered.source, grid);
    for (int bin = 0; bin < grid.size(); ++bin) {
      if (!above[bin] || counts[bin] == 0) continue;
      ++filled;
      for (int c = 0; c < kChannels; ++c) {
        table.SetValue(c, bin, sums[bin][c] / counts[bin]);
      }
    }
    if (filled >= kFilled * static_cast<double>(bins)) return table;
  }
  return std::nullopt;
}

std::optional<HemisphereGrid> GridOf(const Measurement& scattered) {
  if (scattered.table) return std::nullopt;
  CheckDirections(scattered);
  const std::vector<SphericalAngles>& directions = scattered.samples.directions;
  const auto other_light = [&](const SphericalAngles& at) {
    return at.phi_i != directions.front().phi_i;
  };
  if (std::ranges::none_of(directions, other_light)) return std::nullopt;
  std::vector<double> thetas = {0}, phis = {0};
  for (const SphericalAngles& at : scattered.samples.directions) {
    for (const double theta : {at.theta_i, at.theta_o}) thetas.push_back(theta);
    for (const double phi : {at.phi_i, at.phi_o}) {
      phis.push_back(phi - 2 * kPi * std::floor(phi / (2 * kPi)));
    }
  }
  const HemisphereGrid grid = {StepsOf(std::move(thetas), kPi / 2),
                               StepsOf(std::move(phis), 2 * kPi)};
  const int64_t nodes = int64_t{grid.thetas} * grid.phis;
  if (nodes < 1 || nodes > kMostNodes || grid.phis < 3) return std::nullopt;
  // Pairs up to the last theta.
  const double rings = std::round(scattered.max_theta / grid.ThetaStep()) + 1;
  const double pairs = rings * grid.phis * rings * grid.phis;
  if (scattered.samples.size() < pairs / 2) return std::nullopt;
  std::vector<bool> taken(nodes * nodes);
  for (const SphericalAngles& at : scattered.samples.directions) {
    const auto i = grid.Find(at.theta_i, at.phi_i), o = grid.Find(at.theta_o, at.phi_o);
    if (!i || !o || taken[*i * nodes + *o]) return std::nullopt;
    taken[*i * nodes + *o] = true;
  }
  return grid;
}

PictureData PictureDataOf(const Measurement& measurement) {
  return PictureDataOf(measurement, GridOf(measurement));
}

PictureData PictureDataOf(const Measurement& measurement,
                          const std::optional<HemisphereGrid>& grid) {
  if (measurement.table) return {.table = &*measurement.table};
  if (!grid) return {.scattered = &measurement};
  return {.nodes = NodeBrdf(ValuesAtNodes(measurement, *grid)), .formula = measurement.formula};
}

void CheckIsotropic(const PictureData& measured, const Material& fitted) {
  if (measured.table == nullptr) {
    throw Error(ErrorKind::kUnsupported,
                "scattered samples that stand on no grid of directions make no picture")
        .About("grid");
  }
  if (!fitted.angular) {
    throw ErrorIn(ErrorKind::kUnsupported, measured.table->source,
                  "a table knows no azimuths, which an anisotropic model needs")
        .About("anisotropic");
  }
}

AppearanceReport CompareAppearance(const PictureData& measured, const Material& fitted,
                                   const AppearanceOptions& options) {
  if (measured.nodes) {
    return CompareAppearance(*measured.nodes, fitted.spherical, options, measured.formula);
  }
  CheckIsotropic(measured, fitted);
  return CompareAppearance(*measured.table, fitted.angular, options);
}

}  // namespace trilobe
