#include "model/measurement/outliers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/math/quantile.h"
#include "model/measurement/surroundings.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/merl_grid.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

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

// Whether a value is off the median of some by more than kOff and by kScatter times what these are
// off it themselves, in the median. Reorders them.
bool StandsOut(double own, std::vector<double>* values) {
  const double median = Quantile(values, 0.5);
  if (!(own > median * kOff || own < median / kOff)) return false;
  if (!(median > 0)) return false;
  std::vector<double> off(values->size());
  std::ranges::transform(*values, off.begin(),
                         [&](double x) { return std::abs(std::log(x / median)); });
  return std::abs(std::log(own / median)) > kScatter * Quantile(&off, 0.5);
}

// The samples by the bins of their grid, in which scattered ones lie as well.
class Surroundings {
 public:
  Surroundings(const BrdfSamples& samples, int num_threads)
      : grid_(samples.grid),
        on_grid_(samples.on_grid()),
        begin_(grid_.size() + 1, 0),
        bins_(samples.size()) {
    for (int j = 0; j < samples.size(); ++j) {
      bins_[j] = samples.on_grid() ? samples.bins[j] : grid_.Bin(samples.angles[j]);
      ++begin_[bins_[j] + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    values_.resize(samples.size());
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for (int j = 0; j < samples.size(); ++j) values_[next[bins_[j]]++] = Mean(samples.rho[j]);
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

  // What is said of a sample of this value if it is far off the median around it.
  std::optional<Outlier> FarOff(int sample, double own) const {
    const int row = bins_[sample] / grid_.phi_d, p = bins_[sample] % grid_.phi_d;
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
      // Samples that lie farther apart, or anywhere, differ by what is between them, too.
      const bool close = on_grid_ && reach == 1;
      if (!far_off && !(close && StandsOut(h, d, p, reach, own))) return std::nullopt;
      return Outlier{.sample = sample, .median = MedianAround(h, d, p, reach), .far = far_off};
    }
    return std::nullopt;
  }

 private:
  // Of the five bins about one in its row.
  struct Line {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    int samples = 0;
  };

  // Among all around it, those of its own theta_h, and those of its own theta_d.
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

  // What is true of nearly all samples, and soon known.
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

  // The samples of a row about phi_d bin `p`.
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
  std::vector<int> bins_;       // of the samples
  std::vector<double> values_;  // means over the channels, by bins
  std::vector<Line> lines_;     // by bins
};

}  // namespace

std::vector<Outlier> FindOutliers(const BrdfSamples& samples, int num_threads) {
  const Surroundings surroundings(samples, num_threads);
  std::vector<std::optional<Outlier>> told(samples.size());
  ParallelForShort(samples.size(), num_threads,
                   [&](int j) { told[j] = surroundings.FarOff(j, Mean(samples.rho[j])); });
  std::vector<Outlier> found;
  for (const std::optional<Outlier>& outlier : told) {
    if (outlier) found.push_back(*outlier);
  }
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

}  // namespace trilobe
