#include "brdf/outliers.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "trilobe/geometry/channels.h"
#include "trilobe/geometry/merl_grid.h"
#include "trilobe/system/parallel.h"

namespace trilobe {
namespace {

constexpr double kFarOff = 8;     // times brighter or darker
constexpr int kFewestAround = 9;  // bins that tell what surrounds one
constexpr int kWidestReach = 8;   // bins of theta_d to each side, where they are few
constexpr double kNotValid = -1;  // in the place of the value of a bin

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

class Surroundings {
 public:
  Surroundings(const BrdfTable& table, int num_threads)
      : grid_(table.grid), mean_(grid_.size(), kNotValid), lines_(grid_.size()) {
    const std::vector<bool> valid = ValidBins(table);
    ParallelFor(grid_.theta_h, num_threads, [&](int h) {
      for (int bin = grid_.Index(h, 0, 0); bin < grid_.Index(h + 1, 0, 0); ++bin) {
        if (!valid[bin]) continue;
        mean_[bin] = Mean({table.Value(0, bin), table.Value(1, bin), table.Value(2, bin)});
      }
      for (int bin = grid_.Index(h, 0, 0); bin < grid_.Index(h + 1, 0, 0); ++bin) {
        Line& line = lines_[bin];
        ForEachInLine(bin / grid_.phi_d, bin % grid_.phi_d, 1, [&](double x) {
          line.least = std::min(line.least, x);
          line.most = std::max(line.most, x);
          ++line.bins;
        });
      }
    });
  }

  bool IsOutlier(int h, int d, int p) const {
    const double own = mean_[grid_.Index(h, d, p)];
    if (own == kNotValid || IsLikeAllAround(h, d, p, own)) return false;
    for (int reach = 1; reach <= kWidestReach; reach *= 2) {
      Count all, same_h, same_d;
      ForEachRow(h, d, reach, [&](int i, int j) {
        ForEachInLine(grid_.theta_d * i + j, p, reach, [&](double x) {
          all.Add(x, own);
          if (i == h) same_h.Add(x, own);
          if (j == d) same_d.Add(x, own);
        });
      });
      if (!all.Tells()) continue;
      return all.FarOff() && (!same_h.Tells() || same_h.FarOff()) &&
             (!same_d.Tells() || same_d.FarOff());
    }
    return false;
  }

 private:
  // Of the five bins about one in its row.
  struct Line {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    int bins = 0;
  };

  // What is true of nearly all bins, and soon known.
  bool IsLikeAllAround(int h, int d, int p, double own) const {
    Line around;
    ForEachRow(h, d, 1, [&](int i, int j) {
      const Line& line = lines_[grid_.Index(i, j, p)];
      around.least = std::min(around.least, line.least);
      around.most = std::max(around.most, line.most);
      around.bins += line.bins;
    });
    return around.bins >= kFewestAround && around.most <= own * kFarOff &&
           around.least >= own / kFarOff;
  }

  template <typename Work>
  void ForEachRow(int h, int d, int reach, const Work& work) const {
    for (int i = std::max(h - 1, 0); i <= std::min(h + 1, grid_.theta_h - 1); ++i) {
      for (int j = std::max(d - reach, 0); j <= std::min(d + reach, grid_.theta_d - 1); ++j) {
        work(i, j);
      }
    }
  }

  // The valid bins of a row about phi_d bin `p`; 180 degrees further on it begins again, each bin
  // being there once.
  template <typename Work>
  void ForEachInLine(int row, int p, int reach, const Work& work) const {
    const double* const values = mean_.data() + row * grid_.phi_d;
    const int bins = std::min(4 * reach + 1, grid_.phi_d);
    for (int k = 0, at = p - bins / 2; k < bins; ++k, ++at) {
      const double x = values[at < 0              ? at + grid_.phi_d
                              : at >= grid_.phi_d ? at - grid_.phi_d
                                                  : at];
      if (x != kNotValid) work(x);
    }
  }

  const MerlGrid grid_;
  std::vector<double> mean_;
  std::vector<Line> lines_;
};

}  // namespace

std::vector<int> FindOutliers(const BrdfTable& table, int num_threads) {
  const MerlGrid& grid = table.grid;
  const Surroundings surroundings(table, num_threads);
  std::vector<std::vector<int>> found(grid.theta_h);
  ParallelFor(grid.theta_h, num_threads, [&](int h) {
    for (int d = 0; d < grid.theta_d; ++d) {
      for (int p = 0; p < grid.phi_d; ++p) {
        if (surroundings.IsOutlier(h, d, p)) found[h].push_back(grid.Index(h, d, p));
      }
    }
  });
  std::vector<int> all;
  for (const std::vector<int>& row : found) all.insert(all.end(), row.begin(), row.end());
  return all;
}

}  // namespace trilobe
