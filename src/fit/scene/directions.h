#ifndef TRILOBE_FIT_SCENE_DIRECTIONS_H_
#define TRILOBE_FIT_SCENE_DIRECTIONS_H_

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "trilobe/core/geometry/directions.h"
#include "trilobe/core/geometry/merl_grid.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Which directions occur in a scene, in one of four forms. The model does not tell a pair of
// directions from the same pair exchanged. So ranges and lists that use one of two bins that fold
// into one (docs/sums.md) use the other, too; a histogram counts each bin by itself.

struct AllDirections {};

// Polar angles [rad] of the two directions; one of them lies in each range, whichever it is.
struct DirectionRanges {
  struct Range {
    double min = 0, max = kPi / 2;
  };
  Range theta_i, theta_o;
};

// Single pairs of directions. Each uses the eight bins between whose centres it lies, out of which
// its value is interpolated.
struct DirectionList {
  std::vector<HalfDiffAngles> directions;
};

// How often each bin of a measurement's grid was read, as a renderer counted. A count weights its
// bin; bins with 0 are not used.
struct DirectionHistogram {
  std::string source;  // for messages
  MerlGrid grid;
  std::vector<double> counts;  // [grid.size()], in its order; finite, >= 0, and not all 0
};

using SceneDirections =
    std::variant<AllDirections, DirectionRanges, DirectionList, DirectionHistogram>;

// Three int32, the numbers of theta_h, theta_d and phi_d bins, and then a float64 for each bin, in
// the order of a plane of a MERL file, all little-endian. Throws Error that names `source`.
DirectionHistogram ParseHistogram(std::string_view bytes, const std::string& source);

// The samples that are used, with their multiplicity: that of the histogram, scaled to a mean of 1,
// which keeps E comparable with that of an unweighted fit. Throws Error if none is left, or if a
// histogram is on another grid than the samples.
BrdfSamples UsedSamples(const BrdfSamples& samples, const SceneDirections& directions);

// The largest polar angle of either direction that a scene sees of a table [rad]: the bound of
// ranges, and of lists and histograms that of the farthest bin among `used`, at its edge.
double LargestAngle(const SceneDirections& directions, const BrdfSamples& used);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_DIRECTIONS_H_
