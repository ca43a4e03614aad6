#include "trilobe/model/measurement/tabulated_brdf.h"

#include <algorithm>
#include <cmath>

#include "core/base/lanes.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/stencil.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

constexpr int kNone = -1;

// LinearStencil, but always with two bins.
struct Place {
  int bin[2];
  double weight[2];

  Place(double coordinate, int bins) {
    const double x = std::clamp(coordinate - 0.5, 0.0, bins - 1.0);
    bin[0] = std::min(static_cast<int>(x), bins - 1);
    bin[1] = std::min(bin[0] + 1, bins - 1);
    const double t = x - bin[0];
    weight[1] = t < kAtEntry ? 0 : t > 1 - kAtEntry ? 1 : t;
    weight[0] = 1 - weight[1];
  }
};

// Replaces each kNone in a sequence of `count` bins, `stride` apart, by the nearest other entry; on
// ties, the earlier one.
void FillFromNearest(int* first, int count, int stride, bool cyclic) {
  const auto at = [&](int i) -> int& { return first[i * stride]; };
  int missing = 0;
  for (int i = 0; i < count; ++i) missing += at(i) == kNone;
  if (missing == 0 || missing == count) return;
  std::vector<int> distance(count, 2 * count);
  // Two sweeps each way carry an entry once around a cycle.
  const int steps = cyclic ? 2 * count : count;
  for (int i = 0; i < count; ++i) {
    if (at(i) != kNone) distance[i] = 0;
  }
  const auto carry = [&](int from, int target) {
    if (distance[from] + 1 >= distance[target]) return;
    distance[target] = distance[from] + 1;
    at(target) = at(from);
  };
  for (int i = 1; i < steps; ++i) carry((i - 1) % count, i % count);
  for (int i = steps - 1; i > 0; --i) carry(i % count, (i - 1) % count);
}

}  // namespace

TabulatedBrdf::TabulatedBrdf(const BrdfTable& table, int num_threads) : grid_(table.grid) {
  const MerlGrid& grid = grid_;
  const std::vector<bool> valid = ValidBins(table);
  if (std::ranges::find(valid, true) == valid.end()) {
    throw ErrorIn(ErrorKind::kData, table.source,
                  "no valid bin; check that the file is a BRDF in MERL layout")
        .About("bins");
  }
  std::vector<int> nearest(grid.size(), kNone);
  const int row = grid.theta_d * grid.phi_d;
  ParallelFor(grid.theta_h, num_threads, [&](int h) {
    const int begin = h * row, end = begin + row;
    for (int bin = begin; bin < end; ++bin) {
      if (valid[bin]) nearest[bin] = bin;
    }
    for (int i = begin; i < end; i += grid.phi_d) {
      FillFromNearest(&nearest[i], grid.phi_d, 1, true);
    }
    for (int i = begin; i < begin + grid.phi_d; ++i) {
      FillFromNearest(&nearest[i], grid.theta_d, grid.phi_d, false);
    }
  });
  ParallelForShort(row, num_threads,
                   [&](int i) { FillFromNearest(&nearest[i], grid.theta_h, row, false); });
  values_.resize(grid.size());
  ParallelFor(grid.theta_h, num_threads, [&](int h) {
    for (int bin = h * row; bin < (h + 1) * row; ++bin) {
      for (int c = 0; c < kChannels; ++c) values_[bin].channel[c] = table.Value(c, nearest[bin]);
    }
  });
}

Rgb TabulatedBrdf::operator()(const DirectionPair& directions) const {
  if (!(directions.wi[2] > 0 && directions.wo[2] > 0)) return {0, 0, 0};
  return Value(grid_.Bin(ToHalfDiff(directions)));
}

Rgb TabulatedBrdf::Interpolate(const DirectionPair& directions) const {
  if (!(directions.wi[2] > 0 && directions.wo[2] > 0)) return {0, 0, 0};
  return Interpolate(ToHalfDiff(directions));
}

Rgb TabulatedBrdf::Interpolate(const HalfDiffAngles& angles) const {
  CheckAngles(angles);
  const Place h(grid_.ThetaHCoordinate(angles.theta_h), grid_.theta_h);
  const Place d(grid_.ThetaDCoordinate(angles.theta_d), grid_.theta_d);
  const double p = angles.phi_d / kPi * grid_.phi_d - 0.5;
  const int p0 = static_cast<int>(std::floor(p));
  const double t = p - p0;
  const int first = p0 < 0 ? grid_.phi_d - 1 : p0, second = p0 + 1 < grid_.phi_d ? p0 + 1 : 0;
  Four<double> rho{};
  for (int a = 0; a < 2; ++a) {
    for (int b = 0; b < 2; ++b) {
      const Colour* const row = &values_[grid_.Index(h.bin[a], d.bin[b], 0)];
      rho += h.weight[a] * d.weight[b] *
             ((1 - t) * Load(row[first].channel) + t * Load(row[second].channel));
    }
  }
  return {rho[0], rho[1], rho[2]};
}

}  // namespace trilobe
