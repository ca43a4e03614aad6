#ifndef TRILOBE_MODEL_APPEARANCE_SEEN_ERROR_H_
#define TRILOBE_MODEL_APPEARANCE_SEEN_ERROR_H_

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Both images are exposed so that the measured one has this mean luminance.
inline constexpr double kMeanLuminance = 0.35;

// Regions of an image. Grazing: theta of light or eye exceeds 60 degrees (on a sphere, theta of the
// eye: the rim, a quarter of the disc). Highlights: other pixels with at least twice the mean
// luminance, measured or fitted.
enum class SeenPlace { kHighlights, kGrazing, kRest };
inline constexpr double kGrazingAngleDegrees = 60;
inline constexpr size_t kNumPlaces = 3;
const char* NameOf(SeenPlace place);  // "highlights"

// CIELAB differences in one region; all 0 if it has no pixel.
struct PlaceError {
  double share = 0;    // fraction of all pixels
  double squares = 0;  // fraction of the sum of all squared differences
  double mean_delta_e = 0;
  double lightness = 0;  // mean of fitted - measured L
  double color = 0;      // fraction of its squares that scaling the light cannot correct
};

// The visible difference of two images.
struct SeenError {
  double psnr_db = 0;       // of the encoded values, peak 1; +infinity for equal images
  double mean_delta_e = 0;  // CIELAB, 1976
  double delta_e_95 = 0;    // 95th percentile over the pixels
  std::array<PlaceError, kNumPlaces> places = {};  // [SeenPlace]

  const PlaceError& at(SeenPlace place) const { return places[static_cast<size_t>(place)]; }
};

// An estimate for a sphere that is a guess in part.
struct WholeSphere {
  double mean_delta_e = 0, psnr_db = 0;  // as of SeenError

  bool operator==(const WholeSphere&) const = default;
};

// Accumulates SeenError pixel by pixel.
class SeenErrorSum {
 public:
  // Takes exposed light, which is clipped at 1 and encoded by the sRGB curve. `weight`: how many
  // pixels show it, above 0.
  void Add(const Rgb& measured, const Rgb& fitted, bool grazing, double weight = 1);

  SeenError Total() const;

 private:
  struct Sum {
    double pixels = 0;
    double delta_e = 0, squares = 0, color_squares = 0, lightness = 0;
  };

  double encoded_squares_ = 0;
  std::vector<double> delta_e_, weights_;
  std::array<Sum, kNumPlaces> sums_ = {};
};

// A uniform patch of the picture that a renderer would make, of brightness rho cos theta_i.
struct SeenPatch {
  Rgb measured{}, fitted{};  // rho [1/sr]
  Cosines cosines;
  double weight = 1;  // how many pixels show it, above 0
};

// The visible difference of what forms no image. The exposure makes the mean clipped luminance of
// the measured patches kMeanLuminance; if too few of them are not black, these are exposed to
// nearly 1. 0 for a black measurement.
SeenError ComparePatches(std::span<const SeenPatch> patches);

// The same for samples, each of them a patch of weight 1. `fitted`: [samples.size()]
SeenError CompareSamples(const BrdfSamples& samples, const std::vector<Rgb>& fitted);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_SEEN_ERROR_H_
