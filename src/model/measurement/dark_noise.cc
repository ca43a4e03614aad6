#include "model/measurement/dark_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/geometry/grid_cosines.h"
#include "core/math/quantile.h"
#include "model/measurement/surroundings.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// Four neighbours along phi_d.
struct Four {
  double signal = 0;      // mean
  double difference = 0;  // third one
  double before = 0;      // that of the four that begins one bin earlier; 0 where there is none
};

std::vector<Four> FoursOf(const BrdfTable& table, const std::vector<bool>& valid, int channel) {
  const MerlGrid& grid = table.grid;
  const GridCosines cosines(grid);
  std::vector<Four> fours;
  for (int row = 0; row < grid.theta_h * grid.theta_d; row += 3) {
    std::array<double, 4> b{};
    int there = 0;
    double before = 0;
    for (int bin = row * grid.phi_d; bin < (row + 1) * grid.phi_d; ++bin) {
      if (!valid[bin]) {
        there = 0;
        before = 0;
        continue;
      }
      std::rotate(b.begin(), b.begin() + 1, b.end());
      b[3] = table.Value(channel, bin) * cosines(bin).i;
      if (++there < 4) continue;
      const double difference = b[0] - 3 * b[1] + 3 * b[2] - b[3];
      fours.push_back({(b[0] + b[1] + b[2] + b[3]) / 4, difference, before});
      before = difference;
    }
  }
  return fours;
}

// The median of a number of some fours.
template <typename Number>
double MedianOf(const Four* begin, const Four* end, const Number& number) {
  std::vector<double> numbers;
  for (const Four* four = begin; four != end; ++four) numbers.push_back(number(*four));
  return Quantile(&numbers, 0.5);
}

// The median of a channel about a valid bin; `values` is room for it.
double MedianAround(const BrdfTable& table, const std::vector<bool>& valid, int channel, int h,
                    int d, int p, std::vector<double>* values) {
  const MerlGrid& grid = table.grid;
  for (int reach = 1; reach <= kWidestReach; reach *= 2) {
    values->clear();
    ForEachRowAround(grid, h, d, reach, [&](int i, int j) {
      ForEachRangeAround(grid, p, reach, [&](int first, int end) {
        for (int bin = grid.Index(i, j, first); bin < grid.Index(i, j, end); ++bin) {
          if (valid[bin]) values->push_back(table.stored[channel][bin]);
        }
      });
    });
    if (values->size() >= kFewestAround) break;
  }
  return Quantile(values, 0.5);
}

DarkNoise DarkNoiseOf(const BrdfTable& table, const std::vector<bool>& valid, int channel) {
  std::vector<Four> fours = FoursOf(table, valid, channel);
  constexpr size_t kFewest = 1000;
  if (fours.size() < kFewest) return {};
  // From the darkest on.
  const std::ptrdiff_t quarter = static_cast<std::ptrdiff_t>(fours.size()) / 4;
  for (int k = 1; k < 4; ++k) {
    std::nth_element(fours.begin() + (k - 1) * quarter, fours.begin() + k * quarter, fours.end(),
                     [](const Four& a, const Four& b) { return a.signal < b.signal; });
  }
  const auto begin = [&](int k) { return fours.data() + k * quarter; };
  const auto signal = [&](int k) {
    return MedianOf(begin(k), begin(k + 1), [](const Four& four) { return four.signal; });
  };
  const auto noise = [&](int k) {
    // Of normal numbers, 0.6745 times the standard deviation, here of 1 + 9 + 9 + 1 values.
    return MedianOf(begin(k), begin(k + 1),
                    [](const Four& four) { return std::abs(four.difference); }) /
           (0.6745 * std::sqrt(20.0));
  };
  constexpr int kDarkest = 0, kSecond = 1, kThird = 2;
  DarkNoise found{.deviation = noise(kSecond)};
  const double darkest = noise(kDarkest), third = noise(kThird);
  if (!(darkest > 0)) return found;
  // All is noise where there is no signal.
  constexpr double kMost = 1e9;
  found.relative = std::min(darkest / signal(kDarkest), kMost);
  found.rise = std::min(darkest / third * (signal(kThird) / signal(kDarkest)), kMost);
  int pairs = 0, alternating = 0;
  for (const Four* four = begin(kDarkest); four != begin(kDarkest + 1); ++four) {
    const double product = four->difference * four->before;
    pairs += product != 0 ? 1 : 0;
    alternating += product < 0 ? 1 : 0;
  }
  if (pairs > 0) found.alternating = static_cast<double>(alternating) / pairs;
  return found;
}

}  // namespace

DarkNoise DarkNoiseOf(const BrdfTable& table, int channel) {
  return DarkNoiseOf(table, ValidBins(table), channel);
}

int SmoothDarkReadings(int num_threads, BrdfTable* table) {
  constexpr double kLeastSignal = 10, kPeak = 20;  // of its noise
  const MerlGrid& grid = table->grid;
  const std::vector<bool> valid = ValidBins(*table);
  std::array<DarkNoise, kChannels> noise;
  ParallelFor(kChannels, num_threads, [&](int c) { noise[c] = DarkNoiseOf(*table, valid, c); });
  if (std::ranges::none_of(noise, &DarkNoise::IsThere)) return 0;
  const GridCosines cosines(grid);
  const BrdfTable measured = *table;
  std::vector<char> changed(grid.size(), 0);
  for (int c = 0; c < kChannels; ++c) {
    if (!noise[c].IsThere()) continue;
    const double unit = noise[c].deviation / kMerlScale[c];
    const double least = kLeastSignal * unit, peak = kPeak * unit;
    ParallelFor(grid.theta_h, num_threads, [&](int h) {
      std::vector<double> values;
      for (int d = 0; d < grid.theta_d; ++d) {
        for (int p = 0; p < grid.phi_d; ++p) {
          const int bin = grid.Index(h, d, p);
          const double cos_i = cosines(bin).i;
          if (!valid[bin] || measured.stored[c][bin] * cos_i > peak) continue;
          const double median = MedianAround(measured, valid, c, h, d, p, &values);
          if (!(median * cos_i < least)) continue;
          table->stored[c][bin] = median;
          changed[bin] = 1;
        }
      }
    });
  }
  return static_cast<int>(std::ranges::count(changed, 1));
}

}  // namespace trilobe
