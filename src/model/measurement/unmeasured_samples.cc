#include "model/measurement/unmeasured_samples.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <utility>

#include "core/base/quantile.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"

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

// Zeros about the light itself, beside others that are not dark: there a detector stands in its
// own. Unlike others they tell so where every sample has a light of its own.
std::vector<int> ZerosInShadow(const BrdfSamples& samples) {
  constexpr size_t kFewest = 10;
  constexpr double kShare = 0.9;
  const double widest = DegreesToRadians(20), beside = DegreesToRadians(10);
  const auto from_light = [&](int j) { return 2 * samples.Angles(j).theta_d; };
  std::vector<double> of_zeros, all;
  for (int j = 0; j < samples.size(); ++j) {
    if (IsZero(samples.rho[j])) {
      of_zeros.push_back(from_light(j));
    } else {
      all.push_back(Mean(samples.rho[j]));
    }
  }
  if (of_zeros.size() < kFewest) return {};
  const double reach = Quantile(&of_zeros, kShare);
  std::vector<int> zeros;
  std::vector<double> around;
  int dark = 0, within = 0;
  for (int j = 0; j < samples.size(); ++j) {
    const double angle = from_light(j);
    const bool is_zero = IsZero(samples.rho[j]);
    if (angle > reach + beside) continue;
    if (is_zero) zeros.push_back(j);
    if (angle > reach) {
      around.push_back(Mean(samples.rho[j]));
    } else {
      ++within;
      dark += is_zero ? 1 : 0;
    }
  }
  if (reach > widest || dark < kShare * within || around.size() < kFewest) return {};
  const bool is_dark = Quantile(&around, 0.5) < Quantile(&all, 0.25) / 2;
  return is_dark ? std::vector<int>() : zeros;
}

// Whether 0 is far below all else that was measured, and no next level of a detector.
bool AreZerosApart(const BrdfSamples& samples) {
  constexpr double kDark = 0.1;
  std::vector<double> lit;
  for (const Rgb& rho : samples.rho) {
    if (!IsZero(rho)) lit.push_back(Mean(rho));
  }
  if (2 * lit.size() < samples.rho.size()) return false;
  const double least = std::ranges::min(lit), median = Quantile(&lit, 0.5);
  return least > kDark * median && LastLevel(lit) < 3 * kDark * median;
}

}  // namespace

std::vector<int> FindZeroGaps(const BrdfSamples& samples) {
  constexpr int kMostOf = 5, kFewestIn = 500;
  const auto zeros = static_cast<size_t>(std::ranges::count_if(samples.rho, IsZero));
  if (zeros == 0 || kFewestIn * zeros < samples.rho.size()) return {};
  if (AreZerosApart(samples)) {
    std::vector<int> all;
    for (int j = 0; j < samples.size(); ++j) {
      if (IsZero(samples.rho[j])) all.push_back(j);
    }
    return all;
  }
  if (kMostOf * zeros > samples.rho.size()) return {};
  std::vector<int> gaps = ZerosInShadow(samples);
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
  gaps.erase(std::unique(gaps.begin(), gaps.end()), gaps.end());
  if (kFewestIn * gaps.size() < samples.rho.size()) gaps.clear();
  return gaps;
}

namespace {

// One of the angles of all samples, in whole steps of kSameAngle from -2^19 on, and how many of the
// angles that occur are smaller than each.
class SteppedAngles {
 public:
  static constexpr int kBits = 20;  // of a number of steps

  void Add(double angle) {
    constexpr int64_t kMost = 1 << (kBits - 1);
    steps_.push_back(
        static_cast<int>(std::clamp(Rounded(angle) + kMost, int64_t{0}, 2 * kMost - 1)));
  }
  void Rank() {
    const auto [least, most] = std::ranges::minmax(steps_);
    first_ = least;
    rank_.assign(most - least + 1, 0);
    for (const int steps : steps_) rank_[steps - first_] = 1;
    size_ = std::reduce(rank_.begin(), rank_.end());
    std::exclusive_scan(rank_.begin(), rank_.end(), rank_.begin(), 0);
  }

  int size() const { return size_; }  // of those that occur
  int Steps(int sample) const { return steps_[sample]; }
  int RankOf(int steps) const { return rank_[steps - first_]; }

 private:
  std::vector<int> steps_, rank_;  // [samples], [steps from the first one on]
  int first_ = 0, size_ = 0;
};

// Another angle and that which may have been filled in, in one number, and the sample.
using GridSample = std::pair<uint64_t, int>;

// Whether each angle of a kind, in ascending order, repeats the one before; empty if none does.
std::vector<bool> RepeatedAngles(const BrdfSamples& samples, const SteppedAngles& angle,
                                 const SteppedAngles& other, const SteppedAngles& another) {
  constexpr int kFewestAngles = 5, kFewestPlaces = 20;
  constexpr double kShare = 0.9;
  const int size = angle.size();
  if (size < kFewestAngles) return {};
  constexpr int kBits = SteppedAngles::kBits;
  std::vector<int> begin(other.size() + 1, 0);  // of the samples at each angle of `other`
  for (int j = 0; j < samples.size(); ++j) ++begin[other.RankOf(other.Steps(j)) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<GridSample> places(samples.size());
  std::vector<int> next = begin;
  for (int j = 0; j < samples.size(); ++j) {
    const uint64_t at = static_cast<uint64_t>(another.Steps(j)) << kBits | angle.Steps(j);
    places[next[other.RankOf(other.Steps(j))]++] = {at, j};
  }
  const auto rank_of = [&](const GridSample& place) {
    return angle.RankOf(static_cast<int>(place.first % (1 << kBits)));
  };
  struct Count {
    int places = 0, equal = 0;
    std::set<Rgb> values;  // where they are equal
  };
  std::vector<Count> counts(size);
  const auto look_at = [&](const GridSample& first, const GridSample& second) {
    if (first.first >> kBits != second.first >> kBits) return;
    const int rank = rank_of(second);
    const Rgb& rho = samples.rho[second.second];
    if (rank != rank_of(first) + 1 || IsZero(rho)) return;
    ++counts[rank].places;
    if (samples.rho[first.second] != rho) return;
    ++counts[rank].equal;
    counts[rank].values.insert(rho);
  };
  for (int k = 0; k < other.size(); ++k) {
    const std::span<GridSample> alike{places.begin() + begin[k], places.begin() + begin[k + 1]};
    std::ranges::sort(alike);
    for (size_t n = 1; n < alike.size(); ++n) look_at(alike[n - 1], alike[n]);
  }
  std::vector<bool> repeated(size);
  for (int k = 0; k < size; ++k) {
    // Few values are those of a material that reflects alike in all of these directions.
    const Count& count = counts[k];
    repeated[k] = count.places >= kFewestPlaces && count.equal > kShare * count.places &&
                  4 * count.values.size() >= static_cast<size_t>(count.equal);
  }
  const auto total = std::ranges::count(repeated, true);
  return total > 0 && 2 * total < size ? repeated : std::vector<bool>();
}

bool Contains(const std::vector<bool>& repeated, const SteppedAngles& angle, int sample) {
  return !repeated.empty() && repeated[angle.RankOf(angle.Steps(sample))];
}

}  // namespace

FilledSamples FindFilled(const BrdfSamples& samples) {
  if (samples.size() == 0) return {};
  SteppedAngles theta_i, theta_o, phi;
  for (const SphericalAngles& at : samples.directions) {
    theta_i.Add(at.theta_i);
    theta_o.Add(at.theta_o);
    phi.Add(std::remainder(at.phi_o - at.phi_i, 2 * kPi));
  }
  theta_i.Rank();
  theta_o.Rank();
  const std::vector<bool> of_theta_i = RepeatedAngles(samples, theta_i, theta_o, phi);
  const std::vector<bool> of_theta_o = RepeatedAngles(samples, theta_o, theta_i, phi);
  FilledSamples filled = {.samples = {},
                          .theta_i = static_cast<int>(std::ranges::count(of_theta_i, true)),
                          .theta_o = static_cast<int>(std::ranges::count(of_theta_o, true)),
                          .all_theta_i = theta_i.size(),
                          .all_theta_o = theta_o.size()};
  if (of_theta_i.empty() && of_theta_o.empty()) return filled;
  for (int j = 0; j < samples.size(); ++j) {
    if (Contains(of_theta_i, theta_i, j) || Contains(of_theta_o, theta_o, j)) {
      filled.samples.push_back(j);
    }
  }
  return filled;
}

}  // namespace trilobe
