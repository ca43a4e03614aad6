#ifndef TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_STATS_H_
#define TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_STATS_H_

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// Bins of a table by what can be done with them; the reasons do not overlap.
struct BinCounts {
  int total = 0;
  int valid = 0;
  int below_surface = 0;  // a direction is below the surface at the centre
  int non_finite = 0;     // above it, but a channel is NaN or infinite
  int negative = 0;       // above it and finite, but a channel is below 0: marked as lost
  int missing = 0;        // above it, but the file has no value there
  // None of these, but not measured (Unmeasured).
  int extrapolated = 0;
  int beyond_nodes = 0;
  int beyond_max_angle = 0;
  int below_min_theta_d = 0;
};
BinCounts CountBins(const BrdfTable& table);

// "12 of 20 bins valid".
std::string ValidText(const BinCounts& counts, const std::string& whole);

// What part of the bins above the surface is valid, for each cell of 1 degree x 1 degree of
// (theta_i, theta_o), [90][90], theta_o fastest; NaN where a cell holds no such bin's centre.
std::vector<double> ValidShares(const BrdfTable& table);

// Smallest and largest value of the valid bins [1/sr]; 0 where there is none.
struct ValueRange {
  Rgb min{}, max{};
};
ValueRange RangeOfValidBins(const BrdfTable& table);

// How far apart pairs of values are that should be equal: |a - b| / ((a + b) / 2), from 0 to 2,
// over all pairs and channels.
struct PairError {
  int pairs = 0;
  double median = 0;
  double percentile_95 = 0;
};

PairError ErrorOfPairs(std::span<const std::pair<Rgb, Rgb>> pairs);

// Exchange error of a table: bin (h, d, p) against (h, d, phi_d - 1 - p), where both are valid. The
// two stand for swapped directions after a reflection in the plane of the half vector and the
// normal, so isotropic, reciprocal and mirror-symmetric materials have none. (Reciprocity alone
// cannot be checked: a bin holds both orders.)
PairError ExchangeError(const BrdfTable& table);

// Reciprocity error of a function: rho(wi, wo) against rho(wo, wi), at the centres of the bins of
// `grid` that are above the surface and where both orders were measured, as the function says.
using MeasuredFunction = std::function<bool(const DirectionPair&)>;
PairError ReciprocityError(
    const BrdfFunction& brdf, const MerlGrid& grid, int num_threads,
    const MeasuredFunction& measured = [](const DirectionPair&) { return true; });

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_STATS_H_
