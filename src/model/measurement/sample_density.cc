#include "model/measurement/sample_density.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {
namespace {

constexpr int kThetas = 12, kAzimuths = 12;

// Cell of two directions, in either order. Angles at a bound between cells, as on regular grids,
// belong to the upper one.
int CellOf(const SphericalAngles& at) {
  const auto part = [](double share, int parts) {
    constexpr double kRounding = 1e-6;
    return std::clamp(static_cast<int>(share * parts + kRounding), 0, parts - 1);
  };
  int i = part(at.theta_i / (kPi / 2), kThetas), o = part(at.theta_o / (kPi / 2), kThetas);
  if (i > o) std::swap(i, o);
  const double between = std::abs(std::remainder(at.phi_i - at.phi_o, 2 * kPi));
  return (i * kThetas + o) * kAzimuths + part(between / kPi, kAzimuths);
}

}  // namespace

std::vector<double> EvenMultiplicity(const BrdfSamples& samples) {
  constexpr double kTimes = 4, kRounding = 1e-9;
  if (samples.on_grid()) return samples.multiplicity;
  std::vector<int> cells(samples.size());
  std::vector<double> counts(kThetas * kThetas * kAzimuths);
  for (int j = 0; j < samples.size(); ++j) {
    cells[j] =
        CellOf(samples.directions.empty() ? ToSphericalAngles(ToDirections(samples.angles[j]))
                                          : samples.directions[j]);
    counts[cells[j]] += samples.Multiplicity(j);
  }
  std::vector<double> filled;
  std::ranges::copy_if(counts, std::back_inserter(filled), [](double count) { return count > 0; });
  if (filled.empty()) return samples.multiplicity;
  const auto middle = filled.begin() + static_cast<std::ptrdiff_t>(filled.size() / 2);
  std::ranges::nth_element(filled, middle);
  const double most = kTimes * *middle;
  const auto is_dense = [&](double count) { return count > (1 + kRounding) * most; };
  if (std::ranges::none_of(counts, is_dense)) return samples.multiplicity;
  std::vector<double> multiplicity = samples.multiplicity;
  multiplicity.resize(samples.rho.size(), 1);
  for (int j = 0; j < samples.size(); ++j) {
    const double count = counts[cells[j]];
    if (is_dense(count)) multiplicity[j] *= most / count;
  }
  return multiplicity;
}

void EvenOutDensity(BrdfSamples* samples) { samples->multiplicity = EvenMultiplicity(*samples); }

}  // namespace trilobe
