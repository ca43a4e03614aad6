#ifndef TRILOBE_MODEL_MEASUREMENT_STATS_H_
#define TRILOBE_MODEL_MEASUREMENT_STATS_H_

#include "trilobe/model/albedo.h"
#include "trilobe/model/brdf_table.h"
#include "trilobe/model/channels.h"

namespace trilobe {

// Bins of a table by what can be done with them; the reasons do not overlap.
struct BinCounts {
  int total = 0;
  int valid = 0;
  int below_surface = 0;  // a direction is below the surface at the centre
  int non_finite = 0;     // above it, but a channel is NaN or infinite
  int negative = 0;       // above it and finite, but a channel is below 0: marked as lost
};
BinCounts CountBins(const BrdfTable& table);

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

// Exchange error of a table: bin (h, d, p) against (h, d, phi_d - 1 - p), where both are valid. The
// two stand for swapped directions after a reflection in the plane of the half vector and the
// normal, so isotropic, reciprocal and mirror-symmetric materials have none. (Reciprocity alone
// cannot be checked: a bin holds both orders.)
PairError ExchangeError(const BrdfTable& table);

// Reciprocity error of a function: rho(wi, wo) against rho(wo, wi), at the centres of the bins of
// `grid` that are above the surface.
PairError ReciprocityError(const BrdfFunction& brdf, const MerlGrid& grid, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_STATS_H_
