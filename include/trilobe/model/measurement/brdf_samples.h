#ifndef TRILOBE_MODEL_MEASUREMENT_BRDF_SAMPLES_H_
#define TRILOBE_MODEL_MEASUREMENT_BRDF_SAMPLES_H_

#include <string>
#include <vector>

#include "trilobe/core/base/check.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/core/geometry/merl_grid.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// What a fit sees: measured directions and values, all valid, whatever the file was.
// Either every sample stands at the centre of a bin of `grid` (`bins` says which, ascending), or
// the samples are scattered (`angles` says where) and the grid only names the tables' bins.
struct BrdfSamples {
  std::string source;
  MerlGrid grid;
  std::vector<int> bins;               // [n], or empty when scattered
  std::vector<HalfDiffAngles> angles;  // [n], or empty when on the grid
  std::vector<Rgb> rho;                // [n], BRDF [1/sr], finite and >= 0
  // [n], or empty where all are 1: what the weighting's weight of a sample is multiplied by, finite
  // and >= 0; how often the sample counts.
  std::vector<double> multiplicity = {};
  // Scattered samples may know their directions besides, with the order of wi and wo and their
  // azimuths, which `angles` do not tell and anisotropic models ask for: [n], or empty.
  std::vector<SphericalAngles> directions = {};

  int size() const { return static_cast<int>(rho.size()); }
  bool on_grid() const { return angles.empty(); }
  // These and what follows throw Error where there is no such sample.
  double Multiplicity(int j) const {
    CheckIndex(j, size(), "the sample");
    return multiplicity.empty() ? 1 : multiplicity[j];
  }
  HalfDiffAngles Angles(int j) const {
    if (!on_grid()) {
      CheckIndex(j, static_cast<int64_t>(angles.size()), "the sample");
      return angles[j];
    }
    CheckIndex(j, static_cast<int64_t>(bins.size()), "the sample");
    return grid.Center(bins[j]);
  }
  // Of wi and wo in this order, where the directions are known: `angles` may exchange them.
  Cosines CosinesOf(int j) const;
  // The measure of the pairs of directions that a sample stands for, in some unit; 1 where
  // scattered.
  double SolidAngle(int j) const;
};

// Throws Error, with the source and the first sample that is wrong, unless the samples are as said
// above: bins of the grid, or angles, of two directions above the surface, and as many as values.
void CheckSamples(const BrdfSamples& samples);

// The valid bins of a table. Throws Error when there is none.
BrdfSamples ValidSamples(const BrdfTable& table);

// The samples whose numbers in `samples` are these, in this order. [any size] Throws Error for a
// number that none has.
BrdfSamples Selected(const BrdfSamples& samples, const std::vector<int>& numbers);

// About one in `stride` >= 1 of them, for a cheap look at the same problem: on a grid, of each
// (theta_h, theta_d) every stride-th phi_d and its mirror, 180 degrees - phi_d, beginning with
// another one in each row; of scattered ones evenly spread over their order. At least one, where
// there is any. Throws Error for other strides.
BrdfSamples Thinned(const BrdfSamples& samples, int stride);

// Those of every other (theta_h, theta_d), as on a chessboard; at least one, where there is any.
// Throws Error for scattered ones.
BrdfSamples InEveryOtherRow(const BrdfSamples& samples);

// The samples of a grid with half the bins of theta_h and of theta_d: means of up to four, which
// count as often as these together, of one in `stride` >= 1 of its bins, chosen as in Thinned.
// None for a bin whose own centre is of a direction below the surface. Throws Error for other
// strides, scattered samples, and an odd number of bins of theta_h or theta_d.
BrdfSamples MeansOfFourBins(const BrdfSamples& samples, int stride);

// About `count` >= 1 of them for a mean, evenly spread over their order, or all if there are fewer
// than twice as many. On a grid they are of all phi_d. Throws Error for other counts.
BrdfSamples EvenlySpread(const BrdfSamples& samples, int count);

// The same as Thinned where few samples lie by smaller strides, down to 1, so that about `least` >=
// 1 of each bin of theta_h, of theta_d, and of each degree of theta_i and theta_o are left, or all
// that there are. Each counts as many times as there are in its stride. Throws Error as above.
BrdfSamples ThinnedByPlace(const BrdfSamples& samples, int stride, int least);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_BRDF_SAMPLES_H_
