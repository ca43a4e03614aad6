#include "model/measurement/bad_readings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "core/base/grid_cosines.h"
#include "core/base/quantile.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// The neighbourhood of a bin: 3 x 3 x 5 bins of theta_h, theta_d and phi_d with itself or, if these
// have too few values, `reach` times as many of theta_d and phi_d to each side.
constexpr int kFewestAround = 9;  // values that tell what surrounds one
constexpr int kWidestReach = 8;   // it doubles up to that

// Calls work(theta_h, theta_d) for each row of the neighbourhood.
template <typename Work>
void ForEachRowAround(const MerlGrid& grid, int h, int d, int reach, const Work& work) {
  for (int i = std::max(h - 1, 0); i <= std::min(h + 1, grid.theta_h - 1); ++i) {
    for (int j = std::max(d - reach, 0); j <= std::min(d + reach, grid.theta_d - 1); ++j) {
      work(i, j);
    }
  }
}

// Calls work(first, end) for the ranges of phi_d in a row around bin `p`, periodic in 180 degrees;
// no bin occurs twice.
template <typename Work>
void ForEachRangeAround(const MerlGrid& grid, int p, int reach, const Work& work) {
  const int phis = grid.phi_d, bins = std::min(4 * reach + 1, phis);
  const int first = p - bins / 2, end = first + bins;
  if (first < 0) work(first + phis, phis);
  work(std::max(first, 0), std::min(end, phis));
  if (end > phis) work(0, end - phis);
}

constexpr double kFarOff = 8;   // times brighter or darker
constexpr double kOff = 2;      // where the others agree better than that
constexpr double kScatter = 7;  // times the median difference of their logarithms

struct Count {
  int bins = 0, brighter = 0, darker = 0;

  void Add(double x, double own) {
    ++bins;
    brighter += x > own * kFarOff ? 1 : 0;
    darker += x < own / kFarOff ? 1 : 0;
  }
  bool Tells() const { return bins >= kFewestAround; }
  bool FarOff() const { return 2 * brighter > bins || 2 * darker > bins; }
};

// Whether a value differs from the median by a factor above kOff, and in the logarithm by more than
// kScatter times the values' own median deviation. Reorders them.
bool StandsOut(double own, std::vector<double>* values) {
  const double median = Quantile(values, 0.5);
  if (!(own > median * kOff || own < median / kOff)) return false;
  if (!(median > 0)) return false;
  std::vector<double> off(values->size());
  std::ranges::transform(*values, off.begin(),
                         [&](double x) { return std::abs(std::log(x / median)); });
  return std::abs(std::log(own / median)) > kScatter * Quantile(&off, 0.5);
}

// The samples by bins of their grid, also scattered ones.
class Surroundings {
 public:
  Surroundings(const BrdfSamples& samples, int num_threads)
      : grid_(samples.grid), on_grid_(samples.on_grid()), begin_(grid_.size() + 1, 0) {
    std::vector<int> bins(samples.size());
    for (int j = 0; j < samples.size(); ++j) {
      bins[j] = samples.on_grid() ? samples.bins[j] : grid_.Bin(samples.angles[j]);
      ++begin_[bins[j] + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    values_.resize(samples.size());
    samples_.resize(samples.size());
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for (int j = 0; j < samples.size(); ++j) {
      const int k = next[bins[j]]++;
      values_[k] = Mean(samples.rho[j]);
      samples_[k] = j;
    }
    lines_.resize(grid_.size());
    ParallelFor(grid_.theta_h, num_threads, [&](int h) {
      for (int bin = grid_.Index(h, 0, 0); bin < grid_.Index(h + 1, 0, 0); ++bin) {
        Line& line = lines_[bin];
        ForEachInLine(bin / grid_.phi_d, bin % grid_.phi_d, 1, [&](double x) {
          line.least = std::min(line.least, x);
          line.most = std::max(line.most, x);
          ++line.samples;
        });
      }
    });
  }

  // Adds the outliers of a theta_h. In the order of bins neighbours are in the cache.
  void AddOutliers(int h, std::vector<Outlier>* outliers) const {
    for (int bin = grid_.Index(h, 0, 0); bin < grid_.Index(h + 1, 0, 0); ++bin) {
      for (int k = begin_[bin]; k < begin_[bin + 1]; ++k) {
        const std::optional<Outlier> outlier = FarOff(bin, samples_[k], values_[k]);
        if (outlier) outliers->push_back(*outlier);
      }
    }
  }

 private:
  // The outlier if this value of a bin is far off the median around it.
  std::optional<Outlier> FarOff(int bin, int sample, double own) const {
    const int row = bin / grid_.phi_d, p = bin % grid_.phi_d;
    const int h = row / grid_.theta_d, d = row % grid_.theta_d;
    if (IsLikeAllAround(h, d, p, own)) return std::nullopt;
    for (int reach = 1; reach <= kWidestReach; reach *= 2) {
      Count all, same_h, same_d;
      ForEachRowAround(grid_, h, d, reach, [&](int i, int j) {
        ForEachInLine(grid_.theta_d * i + j, p, reach, [&](double x) {
          all.Add(x, own);
          if (i == h) same_h.Add(x, own);
          if (j == d) same_d.Add(x, own);
        });
      });
      if (!all.Tells()) continue;
      const bool far_off = all.FarOff() && (!same_h.Tells() || same_h.FarOff()) &&
                           (!same_d.Tells() || same_d.FarOff());
      // More distant and scattered samples also differ by what is between them.
      const bool close = on_grid_ && reach == 1;
      if (!far_off && !(close && StandsOut(h, d, p, reach, own))) return std::nullopt;
      return Outlier{.sample = sample, .median = MedianAround(h, d, p, reach), .far = far_off};
    }
    return std::nullopt;
  }

  // Looks at the five bins around it in its row.
  struct Line {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    int samples = 0;
  };

  // Compares with the neighbourhood, its bins of the same theta_h, and those of the same theta_d.
  bool StandsOut(int h, int d, int p, int reach, double own) const {
    std::vector<double> all, same_h, same_d;
    ForEachRowAround(grid_, h, d, reach, [&](int i, int j) {
      ForEachInLine(grid_.theta_d * i + j, p, reach, [&](double x) {
        all.push_back(x);
        if (i == h) same_h.push_back(x);
        if (j == d) same_d.push_back(x);
      });
    });
    const auto agrees = [&](std::vector<double>* values) {
      return values->size() < kFewestAround || trilobe::StandsOut(own, values);
    };
    return trilobe::StandsOut(own, &all) && agrees(&same_h) && agrees(&same_d);
  }

  double MedianAround(int h, int d, int p, int reach) const {
    std::vector<double> values;
    ForEachRowAround(grid_, h, d, reach, [&](int i, int j) {
      ForEachInLine(grid_.theta_d * i + j, p, reach, [&](double x) { values.push_back(x); });
    });
    return Quantile(&values, 0.5);
  }

  // A fast test that accepts nearly all samples.
  bool IsLikeAllAround(int h, int d, int p, double own) const {
    Line around;
    ForEachRowAround(grid_, h, d, 1, [&](int i, int j) {
      const Line& line = lines_[grid_.Index(i, j, p)];
      around.least = std::min(around.least, line.least);
      around.most = std::max(around.most, line.most);
      around.samples += line.samples;
    });
    return around.samples >= kFewestAround && around.most <= own * kOff &&
           around.least >= own / kOff;
  }

  // The samples of a row around phi_d bin `p`.
  template <typename Work>
  void ForEachInLine(int row, int p, int reach, const Work& work) const {
    ForEachRangeAround(grid_, p, reach, [&](int first, int end) {
      const int* const begin = &begin_[row * grid_.phi_d];
      for (int k = begin[first]; k < begin[end]; ++k) work(values_[k]);
    });
  }

  const MerlGrid grid_;
  const bool on_grid_;
  std::vector<int> begin_;      // of the samples of a bin, among the values
  std::vector<int> samples_;    // their numbers, by bins
  std::vector<double> values_;  // means over the channels, by bins
  std::vector<Line> lines_;     // by bins
};

// Four neighbours along phi_d.
struct FourReadings {
  double signal = 0;      // mean
  double difference = 0;  // third one
  double before = 0;      // that of the group one bin earlier; 0 if there is none
};

std::vector<FourReadings> FoursOf(const BrdfTable& table, const std::vector<bool>& valid,
                                  int channel) {
  const MerlGrid& grid = table.grid;
  const GridCosines cosines(grid);
  std::vector<FourReadings> fours;
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

// The median of number(four) over a range.
template <typename Number>
double MedianOf(const FourReadings* begin, const FourReadings* end, const Number& number) {
  std::vector<double> numbers;
  for (const FourReadings* four = begin; four != end; ++four) numbers.push_back(number(*four));
  return Quantile(&numbers, 0.5);
}

// The median of a channel around a valid bin; `values` is scratch space.
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
  std::vector<FourReadings> fours = FoursOf(table, valid, channel);
  constexpr size_t kFewest = 1000;
  if (fours.size() < kFewest) return {};
  // Sorted from dark to bright.
  const std::ptrdiff_t quarter = static_cast<std::ptrdiff_t>(fours.size()) / 4;
  for (int k = 1; k < 4; ++k) {
    std::nth_element(
        fours.begin() + (k - 1) * quarter, fours.begin() + k * quarter, fours.end(),
        [](const FourReadings& a, const FourReadings& b) { return a.signal < b.signal; });
  }
  const auto begin = [&](int k) { return fours.data() + k * quarter; };
  const auto signal = [&](int k) {
    return MedianOf(begin(k), begin(k + 1), [](const FourReadings& four) { return four.signal; });
  };
  const auto noise = [&](int k) {
    // The median of absolute normal numbers is 0.6745 times their standard deviation; a difference
    // has the variance of 1 + 9 + 9 + 1 values.
    return MedianOf(begin(k), begin(k + 1),
                    [](const FourReadings& four) { return std::abs(four.difference); }) /
           (0.6745 * std::sqrt(20.0));
  };
  constexpr int kDarkest = 0, kSecond = 1, kThird = 2;
  DarkNoise found{.deviation = noise(kSecond)};
  const double darkest = noise(kDarkest), third = noise(kThird);
  if (!(darkest > 0)) return found;
  // Without signal, all is noise.
  constexpr double kMost = 1e9;
  found.relative = std::min(darkest / signal(kDarkest), kMost);
  found.rise = std::min(darkest / third * (signal(kThird) / signal(kDarkest)), kMost);
  int pairs = 0, alternating = 0;
  for (const FourReadings* four = begin(kDarkest); four != begin(kDarkest + 1); ++four) {
    const double product = four->difference * four->before;
    pairs += product != 0 ? 1 : 0;
    alternating += product < 0 ? 1 : 0;
  }
  if (pairs > 0) found.alternating = static_cast<double>(alternating) / pairs;
  return found;
}

}  // namespace

std::vector<Outlier> FindOutliers(const BrdfSamples& samples, int num_threads) {
  const Surroundings surroundings(samples, num_threads);
  std::vector<std::vector<Outlier>> by_theta_h(samples.grid.theta_h);
  ParallelFor(samples.grid.theta_h, num_threads,
              [&](int h) { surroundings.AddOutliers(h, &by_theta_h[h]); });
  std::vector<Outlier> found;
  for (const std::vector<Outlier>& some : by_theta_h) {
    found.insert(found.end(), some.begin(), some.end());
  }
  std::ranges::sort(found, {}, &Outlier::sample);
  return found;
}

double LightOf(const std::vector<Outlier>& outliers, const BrdfSamples& samples) {
  double off = 0, all = 0;
  const auto weight = [&](int j) {
    const Cosines cosines = samples.CosinesOf(j);
    return samples.SolidAngle(j) * cosines.i * cosines.o;
  };
  for (int j = 0; j < samples.size(); ++j) all += weight(j) * Mean(samples.rho[j]);
  for (const Outlier& outlier : outliers) {
    const int j = outlier.sample;
    const double excess = Mean(samples.rho[j]) - outlier.median;
    off += weight(j) * std::abs(excess);
    all -= weight(j) * excess;
  }
  return all > 0 ? off / all : 0;
}

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
