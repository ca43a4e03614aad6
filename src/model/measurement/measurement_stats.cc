#include "trilobe/model/measurement/measurement_stats.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/grid_cosines.h"
#include "core/base/quantile.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// Relative to the mean, which rounds to 0 if one value is 0 and the other the smallest number.
double RelativeDifference(double a, double b) {
  const double mean = a / 2 + b / 2;
  return a == b ? 0 : mean > 0 ? std::abs(a - b) / mean : 2;
}

double Percentile(std::vector<double>* values, double fraction) {
  return values->empty() ? 0 : Quantile(values, fraction);
}

PairError Summarize(std::vector<double> differences) {
  PairError error;
  error.pairs = static_cast<int>(differences.size()) / kChannels;
  error.median = Percentile(&differences, 0.5);
  error.percentile_95 = Percentile(&differences, 0.95);
  return error;
}

}  // namespace

PairError ErrorOfPairs(std::span<const std::pair<Rgb, Rgb>> pairs) {
  std::vector<double> differences;
  differences.reserve(pairs.size() * kChannels);
  for (const auto& [a, b] : pairs) {
    for (int c = 0; c < kChannels; ++c) differences.push_back(RelativeDifference(a[c], b[c]));
  }
  return Summarize(std::move(differences));
}

std::string ValidText(const BinCounts& counts, const std::string& whole) {
  return std::to_string(counts.valid) + " of " + std::to_string(counts.total) + " " + whole +
         " valid";
}

BinCounts CountBins(const BrdfTable& table) {
  CheckTable(table);
  BinCounts counts{.total = table.grid.size()};
  const std::vector<bool> above = BinsAboveSurface(table.grid);
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    const Rgb stored = {table.stored[0][bin], table.stored[1][bin], table.stored[2][bin]};
    if (!above[bin]) {
      ++counts.below_surface;
    } else if (!std::ranges::all_of(stored, [](double x) { return std::isfinite(x); })) {
      ++counts.non_finite;
    } else if (std::ranges::any_of(stored, [](double x) { return x < 0; })) {
      ++counts.negative;
    } else {
      switch (ReasonOf(table, bin)) {
        case Unmeasured::kNo:
          ++counts.valid;
          break;
        case Unmeasured::kExtrapolated:
          ++counts.extrapolated;
          break;
        case Unmeasured::kBeyondNodes:
          ++counts.beyond_nodes;
          break;
        case Unmeasured::kBeyondMaxAngle:
          ++counts.beyond_max_angle;
          break;
        case Unmeasured::kBelowMinThetaD:
          ++counts.below_min_theta_d;
          break;
      }
    }
  }
  return counts;
}

std::vector<double> ValidShares(const BrdfTable& table) {
  constexpr int kCells = 90;
  std::vector<int> bins(kCells * kCells), valid_bins(kCells * kCells);
  const std::vector<bool> valid = ValidBins(table);
  const GridCosines cosines(table.grid);
  const auto cell_of = [](double cosine) {
    return std::min(static_cast<int>(RadiansToDegrees(std::acos(std::min(cosine, 1.0)))),
                    kCells - 1);
  };
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    const auto [cos_i, cos_o] = cosines(bin);
    if (!(cos_i > 0 && cos_o > 0)) continue;
    const int cell = cell_of(cos_i) * kCells + cell_of(cos_o);
    ++bins[cell];
    if (valid[bin]) ++valid_bins[cell];
  }
  std::vector<double> shares(bins.size(), std::numeric_limits<double>::quiet_NaN());
  for (size_t cell = 0; cell < bins.size(); ++cell) {
    if (bins[cell] > 0) shares[cell] = static_cast<double>(valid_bins[cell]) / bins[cell];
  }
  return shares;
}

ValueRange RangeOfValidBins(const BrdfTable& table) {
  ValueRange range;
  const std::vector<bool> valid = ValidBins(table);
  bool first = true;
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    if (!valid[bin]) continue;
    for (int c = 0; c < kChannels; ++c) {
      const double x = table.Value(c, bin);
      range.min[c] = first ? x : std::min(range.min[c], x);
      range.max[c] = std::max(range.max[c], x);
    }
    first = false;
  }
  return range;
}

PairError ExchangeError(const BrdfTable& table) {
  const MerlGrid& grid = table.grid;
  const std::vector<bool> valid = ValidBins(table);
  std::vector<double> differences;
  differences.reserve(static_cast<size_t>(grid.size()) / 2 * kChannels);
  for (int row = 0; row < grid.size(); row += grid.phi_d) {
    for (int p = 0; p < grid.phi_d / 2; ++p) {
      const int a = row + p, b = row + grid.phi_d - 1 - p;
      if (!valid[a] || !valid[b]) continue;
      for (int c = 0; c < kChannels; ++c) {
        differences.push_back(RelativeDifference(table.Value(c, a), table.Value(c, b)));
      }
    }
  }
  return Summarize(std::move(differences));
}

PairError ReciprocityError(const BrdfFunction& brdf, const MerlGrid& grid, int num_threads,
                           const MeasuredFunction& measured) {
  CheckGrid(grid);
  CheckNotEmpty(brdf, "brdf");
  CheckNotEmpty(measured, "measured");
  std::vector<std::vector<double>> rows(grid.theta_h);
  ParallelFor(grid.theta_h, num_threads, [&](int h) {
    const int size = grid.theta_d * grid.phi_d;
    for (int bin = h * size; bin < (h + 1) * size; ++bin) {
      const DirectionPair pair = ToDirections(grid.Center(bin));
      if (!(pair.wi[2] > 0 && pair.wo[2] > 0)) continue;
      if (!measured(pair) || !measured({pair.wo, pair.wi})) continue;
      const Rgb a = brdf(pair), b = brdf({pair.wo, pair.wi});
      for (int c = 0; c < kChannels; ++c) rows[h].push_back(RelativeDifference(a[c], b[c]));
    }
  });
  std::vector<double> differences;
  for (const auto& row : rows) differences.insert(differences.end(), row.begin(), row.end());
  return Summarize(std::move(differences));
}

}  // namespace trilobe
