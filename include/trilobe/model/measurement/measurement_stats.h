#ifndef TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_STATS_H_
#define TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_STATS_H_

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// Numbers of bins by status; each bin has exactly one.
struct BinCounts {
  int total = 0;
  int valid = 0;
  int below_surface = 0;  // a direction is below the surface at the centre
  int non_finite = 0;     // above it, a channel is NaN or infinite
  int negative = 0;       // above it and finite, a channel is below 0: lost
  int missing = 0;        // above it, without a value in the file
  // Bins with none of these faults that were not measured, by reason (Unmeasured).
  int extrapolated = 0;
  int beyond_nodes = 0;
  int beyond_max_angle = 0;
  int below_min_theta_d = 0;
};
BinCounts CountBins(const BrdfTable& table);

// Text such as "12 of 20 bins valid", with `whole` for "bins".
std::string ValidText(const BinCounts& counts, const std::string& whole);

// Valid fraction of the bins above the surface, by cells of 1 x 1 degree of (theta_i, theta_o).
// [90][90], theta_o fastest; NaN for a cell without bin centres.
std::vector<double> ValidShares(const BrdfTable& table);

// Smallest and largest value of the valid bins [1/sr]; 0 if there are none.
struct ValueRange {
  Rgb min{}, max{};
};
ValueRange RangeOfValidBins(const BrdfTable& table);

// Relative differences of pairs of values that should be equal: |a - b| / ((a + b) / 2), from 0 to
// 2, over all pairs and channels.
struct PairError {
  int pairs = 0;
  double median = 0;
  double percentile_95 = 0;
};

PairError ErrorOfPairs(std::span<const std::pair<Rgb, Rgb>> pairs);

// Exchange error of a table: bin (h, d, p) against (h, d, phi_d - 1 - p), where both are valid. The
// second has exchanged directions, reflected in the plane of half vector and normal, so the error
// of an isotropic, reciprocal and mirror-symmetric material is 0. (Reciprocity alone cannot be
// tested: a bin holds both orders.)
PairError ExchangeError(const BrdfTable& table);

// Reciprocity error of a function: rho(wi, wo) against rho(wo, wi), at bin centres of `grid` above
// the surface for which `measured` is true in both orders.
using MeasuredFunction = std::function<bool(const DirectionPair&)>;
PairError ReciprocityError(
    const BrdfFunction& brdf, const MerlGrid& grid, int num_threads,
    const MeasuredFunction& measured = [](const DirectionPair&) { return true; });

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_STATS_H_
