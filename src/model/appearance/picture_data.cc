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

constexpr int64_t kMostNodes = 3162;  // as of ParseHemisphereGrid

// How many equal steps a range has of which these angles, in [0, range), are ends; 0 where there
// are no two of them.
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

std::optional<HemisphereGrid> GridOf(const Measurement& scattered) {
  if (!scattered.anisotropic) return std::nullopt;
  CheckDirections(scattered);
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
  if (nodes < 1 || nodes > kMostNodes) return std::nullopt;
  // Up to the last theta.
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
  if (measurement.table) return {.table = &*measurement.table};
  const std::optional<HemisphereGrid> grid = GridOf(measurement);
  if (!grid) return {.scattered = &measurement};
  return {.nodes = NodeBrdf(ValuesAtNodes(measurement, *grid)), .formula = measurement.formula};
}

void CheckIsotropic(const PictureData& measured, const Material& fitted) {
  if (measured.table == nullptr) {
    throw Error("scattered samples that stand on no grid of directions make no picture");
  }
  if (!fitted.angular) {
    throw Error(measured.table->source +
                ": a table knows no azimuths, which an anisotropic model needs");
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
