#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "trilobe/core/base/check.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {
namespace {

constexpr int kFewestSamples = 500;
constexpr double kRounded = 1e-5;  // [rad] error of angles in a file of some digits

// The coordinates of a pair of directions in [0, 1], in which the bins of a MerlGrid have the same
// width.
std::array<double, 3> CoordinatesOf(const HalfDiffAngles& at) {
  return {std::sqrt(at.theta_h / (kPi / 2)), at.theta_d / (kPi / 2), at.phi_d / kPi};
}

// Stores a value so that the table has the same, if any stored one does.
void SetExactly(int channel, int bin, double brdf, BrdfTable* table) {
  table->SetValue(channel, bin, brdf);
  double& stored = table->stored[channel][bin];
  const double nearest = stored;
  for (const double towards : {0.0, std::numeric_limits<double>::infinity()}) {
    if (table->Value(channel, bin) == brdf) return;
    stored = std::nextafter(nearest, towards);
  }
  if (table->Value(channel, bin) != brdf) stored = nearest;
}

// The number of bins of one width in [0, 1] whose centres these numbers are, by the median distance
// of neighbours; 0 where there are fewer than two numbers. Changes the order of `values`.
int BinsOf(std::vector<double>* values) {
  constexpr double kSame = 1e-5;  // angles in files of six digits are no more exact
  std::ranges::sort(*values);
  std::vector<double> steps;
  for (size_t k = 1; k < values->size(); ++k) {
    const double step = (*values)[k] - (*values)[k - 1];
    if (step > kSame) steps.push_back(step);
  }
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return static_cast<int>(std::lround(1 / *middle));
}

// The grid on whose bins some of the samples lie, if there is one. Reads directions far from the
// normal, where azimuths of difference vectors are exact.
std::optional<MerlGrid> GridOfSome(const BrdfSamples& samples) {
  constexpr int kRead = 20'000;
  constexpr double kFarFromNormal = DegreesToRadians(5);
  const int stride = std::max(1, samples.size() / kRead);
  std::array<std::vector<double>, 3> read;
  for (int j = 0; j < samples.size(); j += stride) {
    const HalfDiffAngles at = samples.Angles(j);
    if (std::min(at.theta_h, at.theta_d) < kFarFromNormal) continue;
    const std::array<double, 3> coordinates = CoordinatesOf(at);
    for (size_t k = 0; k < 3; ++k) read[k].push_back(coordinates[k]);
  }
  auto& [theta_h, theta_d, phi_d] = read;
  const MerlGrid grid = {BinsOf(&theta_h), BinsOf(&theta_d), BinsOf(&phi_d)};
  constexpr int kFewest = 4, kMost = 360;
  for (const int bins : {grid.theta_h, grid.theta_d, grid.phi_d}) {
    if (bins < kFewest || bins > kMost) return std::nullopt;
  }
  return grid;
}

// Distance [rad] of a pair of directions from the centre of a bin, in whichever order. The azimuth
// of both together does not count.
double DistanceOf(const SphericalAngles& at, const MerlGrid& grid, int bin) {
  const SphericalAngles centre = ToSphericalAngles(ToDirections(grid.Center(bin)));
  const double phi = centre.phi_o - centre.phi_i, sine = std::sin(std::min(at.theta_i, at.theta_o));
  const auto distance = [&](double theta_i, double theta_o, double turn) {
    const double off = std::remainder(at.phi_o - at.phi_i - turn, 2 * kPi) * sine;
    return std::max(
        {std::abs(at.theta_i - theta_i), std::abs(at.theta_o - theta_o), std::abs(off)});
  };
  return std::min(distance(centre.theta_i, centre.theta_o, phi),
                  distance(centre.theta_o, centre.theta_i, -phi));
}

// The bin at whose centre these angles are, or -1.
int BinAt(const HalfDiffAngles& angles, const MerlGrid& grid) {
  constexpr double kAtCentre = 0.1;  // of a bin
  const std::array<int, 3> sizes = {grid.theta_h, grid.theta_d, grid.phi_d};
  const std::array<double, 3> coordinates = CoordinatesOf(angles);
  for (size_t k = 0; k < 3; ++k) {
    const double x = coordinates[k] * sizes[k];
    if (std::abs(x - std::floor(x) - 0.5) > kAtCentre) return -1;
  }
  return grid.Bin(angles);
}

// The nearest of the bins around a sample that is not taken, or -1 if that is farther than
// rounding of angles to some digits explains. Near theta_h = 0 these make phi_d inexact.
int NearestFreeBin(const BrdfSamples& samples, int j, const MerlGrid& grid,
                   const std::vector<bool>& taken) {
  constexpr int kAround = 2;
  const int at = grid.Bin(samples.Angles(j));
  const int h = at / (grid.theta_d * grid.phi_d), d = at / grid.phi_d % grid.theta_d;
  const int p = at % grid.phi_d;
  int nearest = -1;
  double least = kRounded;
  for (int near_h = std::max(0, h - 1); near_h < std::min(grid.theta_h, h + 2); ++near_h) {
    for (int step = -kAround; step <= kAround; ++step) {
      const int bin = grid.Index(near_h, d, (p + step + grid.phi_d) % grid.phi_d);
      if (taken[bin]) continue;
      const double distance = DistanceOf(samples.directions[j], grid, bin);
      if (distance >= least) continue;
      least = distance;
      nearest = bin;
    }
  }
  return nearest;
}

// The number of bins above the surface with both angles up to `max_theta`.
int BinsUpTo(double max_theta, const MerlGrid& grid) {
  BrdfTable whole = MakeInvalidTable("", grid);
  for (std::vector<double>& channel : whole.stored) std::ranges::fill(channel, 0);
  LimitAngles(max_theta, Unmeasured::kBeyondNodes, &whole);
  return CountBins(whole).valid;
}

// The bin of each sample, if all stand at centres, each at another, and fill most of the grid up to
// their largest angle. Else empty.
std::vector<int> BinsOfAll(const BrdfSamples& samples, const MerlGrid& grid, double max_theta) {
  constexpr double kMostRounded = 0.01;  // of all samples
  std::vector<int> bins(samples.size()), rounded;
  std::vector<bool> taken(grid.size());
  for (int j = 0; j < samples.size(); ++j) {
    bins[j] = BinAt(samples.Angles(j), grid);
    if (bins[j] < 0 || taken[bins[j]]) {
      rounded.push_back(j);
      if (static_cast<double>(rounded.size()) > kMostRounded * samples.size()) return {};
    } else {
      taken[bins[j]] = true;
    }
  }
  for (const int j : rounded) {
    bins[j] = NearestFreeBin(samples, j, grid, taken);
    if (bins[j] < 0) return {};
    taken[bins[j]] = true;
  }
  const double fewest = 0.5 * BinsUpTo(max_theta, grid);
  return samples.size() >= fewest ? bins : std::vector<int>{};
}

}  // namespace

void TakeMerlBinsAsTable(Measurement* measurement) {
  NotNull(measurement, "the measurement");
  const BrdfSamples& samples = measurement->samples;
  if (measurement->table || measurement->azimuths_matter || measurement->look_up != nullptr ||
      samples.spectra != nullptr || samples.size() < kFewestSamples) {
    return;
  }
  const std::optional<MerlGrid> grid = GridOfSome(samples);
  if (!grid) return;
  const std::vector<int> bins = BinsOfAll(samples, *grid, measurement->max_theta);
  if (bins.empty()) return;
  BrdfTable table = MakeInvalidTable(measurement->source, *grid);
  for (int j = 0; j < samples.size(); ++j) {
    for (int c = 0; c < kChannels; ++c) SetExactly(c, bins[j], samples.rho[j][c], &table);
  }
  // The largest angle of a whole table is that of its last bins, and no limit.
  constexpr double kWhole = 0.99;
  if (BinsUpTo(measurement->max_theta, *grid) < kWhole * BinsUpTo(kPi / 2, *grid)) {
    LimitAngles(measurement->max_theta + kRounded, Unmeasured::kBeyondNodes, &table);
  }
  std::ostringstream note;
  note << "its samples stand at the centres of " << grid->theta_h << " x " << grid->theta_d << " x "
       << grid->phi_d << " bins of theta_h, theta_d and phi_d: it is a table of these";
  measurement->notes.push_back(note.str());
  const std::string scattered = "scattered samples";
  if (std::string& kind = measurement->kind; kind.ends_with(scattered)) {
    kind.replace(kind.size() - scattered.size(), scattered.size(), "the bins of a table");
  }
  measurement->anisotropic = false;
  measurement->table = std::move(table);
  measurement->samples = {};
  measurement->counts = {};
}

}  // namespace trilobe
