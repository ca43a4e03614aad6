#ifndef TRILOBE_FIT_SCENE_DIRECTIONS_H_
#define TRILOBE_FIT_SCENE_DIRECTIONS_H_

#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Directions that occur in a scene, in one of four forms. The model is reciprocal, so ranges and
// lists that use one of two folded bins (docs/sums.md) use the other, too. A histogram counts each
// bin separately.

struct AllDirections {};

// Ranges of the polar angles [rad] of the two directions, in either order.
struct DirectionRanges {
  struct Range {
    double min = 0, max = kPi / 2;
  };
  Range theta_i, theta_o;
};

// Pairs of directions. Each uses the bins from which its value is interpolated (BinsAround), by
// their shares in it.
struct DirectionList {
  std::vector<HalfDiffAngles> directions;
};

// Counts by a renderer of how often each bin of a measurement's grid was read. They weight the
// bins; bins with 0 are not used.
struct DirectionHistogram {
  std::string source;  // for messages
  MerlGrid grid;
  std::vector<double> counts;  // [grid.size()], in its order; finite, >= 0, and not all 0
};

using SceneDirections =
    std::variant<AllDirections, DirectionRanges, DirectionList, DirectionHistogram>;

// Parses three int32 (numbers of theta_h, theta_d and phi_d bins), then a float64 per bin in the
// order of a plane of a MERL file, little-endian. Throws Error that names `source`.
DirectionHistogram ParseHistogram(std::string_view bytes, const std::string& source);

// The bins that tell of a pair of directions, with the shares of their values, which add up to 1:
// in theta_h and theta_d those that are interpolated between, in phi_d, along which BRDFs change
// little, those within 10 degrees, by a tent, so that noise cancels. Mirror bins, whose directions
// are exchanged, share alike. A bin may occur twice.
struct BinShare {
  int bin;
  double share;
};
std::vector<BinShare> BinsAround(const MerlGrid& grid, const HalfDiffAngles& angles);

// The bin of a sample.
int BinOf(const BrdfSamples& samples, int j);

// The samples of each bin.
class SamplesOfBins {
 public:
  explicit SamplesOfBins(const BrdfSamples& samples);
  const std::vector<int>& operator()(int bin) const;

 private:
  std::unordered_map<int, std::vector<int>> samples_;
};

// The used samples. With a list or a histogram their multiplicity says how often each is read, in
// the place of solid angles (BrdfSamples::counted), scaled to a mean of 1, which keeps E comparable
// with an unweighted fit. Others of an isotropic material, scattered, count less where they are
// dense, as in SamplesOf. Throws Error if none is left, or if a histogram is on another grid than
// the samples.
BrdfSamples UsedSamples(const BrdfSamples& samples, const SceneDirections& directions,
                        bool anisotropic = false);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_DIRECTIONS_H_
