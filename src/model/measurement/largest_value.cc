#include "model/measurement/largest_value.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <sstream>
#include <tuple>
#include <vector>

#include "core/base/quantile.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {
namespace {

constexpr double kSameValue = 1e-6;  // relative

// 999, 9999, ...
bool IsNines(double value) {
  constexpr int kFewest = 3;
  const double digits = std::log10(value + 1);
  return digits >= kFewest && digits == std::round(digits);
}

// Two pairs of directions have the same if they are one, exchanged or mirrored: then values are
// equal without a fault.
std::tuple<int64_t, int64_t, int64_t> KindOfPair(const SphericalAngles& at) {
  constexpr double kStep = 1e-4;  // [rad]
  const auto rounded = [](double x) { return static_cast<int64_t>(std::llround(x / kStep)); };
  const auto [low, high] = std::minmax(at.theta_i, at.theta_o);
  const bool has_azimuth = rounded(low) > 0;
  return {rounded(low), rounded(high), has_azimuth ? rounded(std::cos(at.phi_o - at.phi_i)) : 0};
}

}  // namespace

LargestValueSymptom LargestValueOf(const BrdfSamples& samples) {
  LargestValueSymptom found;
  for (const bool of_signal : {false, true}) {
    for (int c = 0; c < kChannels; ++c) {
      const auto value = [&](int j) {
        return samples.rho[j][c] * (of_signal ? std::cos(samples.directions[j].theta_i) : 1);
      };
      double largest = 0, next = 0;
      for (int j = 0; j < samples.size(); ++j) largest = std::max(largest, value(j));
      if (!(largest > 0)) continue;
      std::set<std::tuple<int64_t, int64_t, int64_t>> pairs;
      std::vector<double> half_angles;
      std::set<int64_t> theta_h, theta_i;
      constexpr double kStep = 1e-4;  // [rad]
      for (int j = 0; j < samples.size(); ++j) {
        if (value(j) <= largest * (1 - kSameValue)) {
          next = std::max(next, value(j));
          continue;
        }
        pairs.insert(KindOfPair(samples.directions[j]));
        half_angles.push_back(samples.angles[j].theta_h);
        theta_h.insert(std::llround(samples.angles[j].theta_h / kStep));
        if (of_signal) theta_i.insert(std::llround(samples.directions[j].theta_i / kStep));
      }
      const int count = static_cast<int>(half_angles.size());
      if (count <= found.samples) continue;
      found = {.value = largest,
               .samples = count,
               .pairs = static_cast<int>(pairs.size()),
               .angles = static_cast<int>(std::max(theta_h.size(), theta_i.size())),
               .theta_h = Quantile(&half_angles, 0.5),
               .over_next = next > 0 ? largest / next : std::numeric_limits<double>::infinity(),
               .is_nines = !of_signal && IsNines(largest),
               .of_signal = of_signal};
    }
  }
  return found;
}

bool HasLargest(const LargestValueSymptom& largest, const BrdfSamples& samples, int j) {
  const double times = largest.of_signal ? std::cos(samples.directions[j].theta_i) : 1;
  return std::ranges::any_of(samples.rho[j], [&](double value) {
    return times * value > largest.value * (1 - kSameValue);
  });
}

std::string MarkText(const LargestValueSymptom& largest) {
  std::ostringstream text;
  text.precision(4);
  text << "the value " << largest.value << " is there " << largest.samples << " times, and is "
       << largest.over_next << " times the next one: it seems to mark what was not measured";
  return text.str();
}

}  // namespace trilobe
