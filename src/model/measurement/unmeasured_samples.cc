#include "model/measurement/unmeasured_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "core/math/quantile.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/core/math/angles.h"

namespace trilobe {
namespace {

constexpr double kSameAngle = 1e-5;  // [rad]

int64_t Rounded(double angle) { return std::llround(angle / kSameAngle); }

bool IsZero(const Rgb& rho) { return std::ranges::max(rho) == 0; }

// The samples of each direction of light.
std::map<std::pair<int64_t, int64_t>, std::vector<int>> ByLight(const BrdfSamples& samples) {
  std::map<std::pair<int64_t, int64_t>, std::vector<int>> incidences;
  for (int j = 0; j < samples.size(); ++j) {
    const SphericalAngles& at = samples.directions[j];
    incidences[{Rounded(at.theta_i), Rounded(at.phi_i)}].push_back(j);
  }
  return incidences;
}

struct Lit {
  Direction wo;
  double rho;
};

// Whether what surrounds a direction is not dark, and no last level of a detector either.
bool IsAmidLight(const Direction& wo, const std::vector<Lit>& lit, double dark) {
  constexpr size_t kMost = 8, kFewest = 4;
  static const double least_cosine = std::cos(DegreesToRadians(30));
  std::vector<std::pair<double, double>> near;  // 1 - cosine, value
  for (const Lit& one : lit) {
    const double cosine = Dot(wo, one.wo);
    if (cosine >= least_cosine) near.emplace_back(1 - cosine, one.rho);
  }
  if (near.size() < kFewest) return false;
  const size_t count = std::min(kMost, near.size());
  std::ranges::partial_sort(near, near.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<double> values;
  for (size_t k = 0; k < count; ++k) values.push_back(near[k].second);
  const auto [low, high] = std::ranges::minmax(values);
  return low < high && 2 * low >= dark && Quantile(&values, 0.5) >= dark;
}

// The least of some values above 0, if a detector has it as its last level: three times or more.
// Else 0.
double LastLevel(const std::vector<double>& values) {
  constexpr int kRepeated = 3;
  const double least = std::ranges::min(values);
  return std::ranges::count(values, least) >= kRepeated ? least : 0;
}

}  // namespace

std::vector<int> FindZeroGaps(const BrdfSamples& samples) {
  constexpr int kMostOf = 5;
  const auto zeros = std::ranges::count_if(samples.rho, IsZero);
  std::vector<int> gaps;
  if (zeros == 0 || kMostOf * zeros > samples.size()) return gaps;
  for (const auto& [light, numbers] : ByLight(samples)) {
    std::vector<Lit> lit;
    std::vector<double> values;
    for (const int j : numbers) {
      if (IsZero(samples.rho[j])) continue;
      values.push_back(Mean(samples.rho[j]));
      lit.push_back({ToDirections(samples.directions[j]).wo, values.back()});
    }
    if (values.empty()) continue;
    const double dark = std::max(Quantile(&values, 0.25) / 2, 3 * LastLevel(values));
    for (const int j : numbers) {
      if (IsZero(samples.rho[j]) &&
          IsAmidLight(ToDirections(samples.directions[j]).wo, lit, dark)) {
        gaps.push_back(j);
      }
    }
  }
  std::ranges::sort(gaps);
  constexpr size_t kFewestIn = 500;
  if (kFewestIn * gaps.size() < samples.rho.size()) gaps.clear();
  return gaps;
}

namespace {

// The angle that may have been filled in, and the two others.
struct GridSample {
  int64_t others[2];
  int64_t angle;
  int sample;
  auto Key() const { return std::array{others[0], others[1], angle}; }
};

// The angles of one kind that repeat the one before.
std::set<int64_t> RepeatedAngles(const BrdfSamples& samples, std::vector<GridSample> places,
                                 int* all_angles) {
  constexpr int kFewestAngles = 5, kFewestPlaces = 20;
  constexpr double kShare = 0.9;
  std::set<int64_t> angles;
  for (const GridSample& place : places) angles.insert(place.angle);
  *all_angles = static_cast<int>(angles.size());
  if (*all_angles < kFewestAngles) return {};
  std::map<int64_t, int64_t> before;  // each angle's
  for (auto at = std::next(angles.begin()); at != angles.end(); ++at) before[*at] = *std::prev(at);
  std::ranges::sort(places, {}, &GridSample::Key);
  struct Count {
    int places = 0, equal = 0;
    std::set<Rgb> values;  // where they are equal
  };
  std::map<int64_t, Count> counts;
  for (size_t k = 1; k < places.size(); ++k) {
    const GridSample &first = places[k - 1], &second = places[k];
    if (!std::ranges::equal(first.others, second.others) || first.angle == second.angle ||
        before.at(second.angle) != first.angle || IsZero(samples.rho[second.sample])) {
      continue;
    }
    Count& count = counts[second.angle];
    ++count.places;
    if (samples.rho[first.sample] != samples.rho[second.sample]) continue;
    ++count.equal;
    count.values.insert(samples.rho[second.sample]);
  }
  std::set<int64_t> repeated;
  for (const auto& [angle, count] : counts) {
    // Few values are those of a material that reflects alike in all of these directions.
    if (count.places >= kFewestPlaces && count.equal > kShare * count.places &&
        4 * count.values.size() >= static_cast<size_t>(count.equal)) {
      repeated.insert(angle);
    }
  }
  return 2 * repeated.size() < angles.size() ? repeated : std::set<int64_t>();
}

}  // namespace

FilledSamples FindFilled(const BrdfSamples& samples) {
  std::vector<GridSample> by_theta_i, by_theta_o;
  for (int j = 0; j < samples.size(); ++j) {
    const SphericalAngles& at = samples.directions[j];
    const int64_t theta_i = Rounded(at.theta_i), theta_o = Rounded(at.theta_o);
    const int64_t phi = Rounded(std::remainder(at.phi_o - at.phi_i, 2 * kPi));
    by_theta_i.push_back({{theta_o, phi}, theta_i, j});
    by_theta_o.push_back({{theta_i, phi}, theta_o, j});
  }
  FilledSamples filled;
  const std::set<int64_t> theta_i =
      RepeatedAngles(samples, std::move(by_theta_i), &filled.all_theta_i);
  const std::set<int64_t> theta_o =
      RepeatedAngles(samples, std::move(by_theta_o), &filled.all_theta_o);
  filled.theta_i = static_cast<int>(theta_i.size());
  filled.theta_o = static_cast<int>(theta_o.size());
  if (theta_i.empty() && theta_o.empty()) return filled;
  for (int j = 0; j < samples.size(); ++j) {
    const SphericalAngles& at = samples.directions[j];
    if (theta_i.contains(Rounded(at.theta_i)) || theta_o.contains(Rounded(at.theta_o))) {
      filled.samples.push_back(j);
    }
  }
  return filled;
}

}  // namespace trilobe
