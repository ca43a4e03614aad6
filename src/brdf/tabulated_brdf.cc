#include "trilobe/brdf/tabulated_brdf.h"

#include <algorithm>
#include <cmath>

#include "trilobe/base/error.h"
#include "trilobe/math/stencil.h"

namespace trilobe {
namespace {

constexpr int kNone = -1;

// Replaces each kNone of a sequence of `count` bins, `stride` apart, by the nearest other entry; of
// two at the same distance, by the earlier.
void FillFromNearest(int* first, int count, int stride, bool cyclic) {
  const auto at = [&](int i) -> int& { return first[i * stride]; };
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

TabulatedBrdf::TabulatedBrdf(const BrdfTable& table) : table_(table) {
  const MerlGrid& grid = table.grid;
  const std::vector<bool> valid = ValidBins(table);
  if (std::ranges::find(valid, true) == valid.end()) {
    throw Error(table.source + ": no valid bin; check that the file is a BRDF in MERL layout");
  }
  nearest_valid_.assign(grid.size(), kNone);
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (valid[bin]) nearest_valid_[bin] = bin;
  }
  const int row = grid.theta_d * grid.phi_d;
  for (int i = 0; i < grid.size(); i += grid.phi_d) {
    FillFromNearest(&nearest_valid_[i], grid.phi_d, 1, true);
  }
  for (int h = 0; h < grid.theta_h; ++h) {
    for (int p = 0; p < grid.phi_d; ++p) {
      FillFromNearest(&nearest_valid_[grid.Index(h, 0, p)], grid.theta_d, grid.phi_d, false);
    }
  }
  for (int i = 0; i < row; ++i) FillFromNearest(&nearest_valid_[i], grid.theta_h, row, false);
}

Rgb TabulatedBrdf::operator()(const DirectionPair& directions) const {
  if (!(directions.wi[2] > 0 && directions.wo[2] > 0)) return {0, 0, 0};
  return Value(table_.grid.Bin(ToHalfDiff(directions)));
}

Rgb TabulatedBrdf::Interpolate(const DirectionPair& directions) const {
  if (!(directions.wi[2] > 0 && directions.wo[2] > 0)) return {0, 0, 0};
  return Interpolate(ToHalfDiff(directions));
}

Rgb TabulatedBrdf::Interpolate(const HalfDiffAngles& angles) const {
  CheckAngles(angles);
  const MerlGrid& grid = table_.grid;
  const Stencil h = LinearStencil(grid.ThetaHCoordinate(angles.theta_h), grid.theta_h);
  const Stencil d = LinearStencil(grid.ThetaDCoordinate(angles.theta_d), grid.theta_d);
  const double p = angles.phi_d / kPi * grid.phi_d - 0.5;
  const int p0 = static_cast<int>(std::floor(p));
  const double t = p - p0;
  const auto wrap = [&](int i) { return (i + grid.phi_d) % grid.phi_d; };
  Rgb rho{};
  for (int a = 0; a < h.size; ++a) {
    for (int b = 0; b < d.size; ++b) {
      const double weight = h.weight[a] * d.weight[b];
      const int bin0 = grid.Index(h.index[a], d.index[b], wrap(p0));
      const int bin1 = grid.Index(h.index[a], d.index[b], wrap(p0 + 1));
      for (int c = 0; c < kChannels; ++c) {
        rho[c] += weight * ((1 - t) * Value(c, bin0) + t * Value(c, bin1));
      }
    }
  }
  return rho;
}

}  // namespace trilobe
