#ifndef TRILOBE_MODEL_APPEARANCE_SEEN_ERROR_H_
#define TRILOBE_MODEL_APPEARANCE_SEEN_ERROR_H_

#include <array>
#include <cstddef>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Both pictures get the exposure that takes the mean luminance of the measured one to this.
inline constexpr double kMeanLuminance = 0.35;

// Where in a picture: grazing is where light or eye stand further than 60 degrees from the normal
// (on a sphere, of the eye: the rim, a quarter of the disc); highlights are what else has at least
// twice the mean luminance, measured or fitted.
enum class SeenPlace { kHighlights, kGrazing, kRest };
inline constexpr double kGrazingAngleDegrees = 60;
inline constexpr size_t kNumPlaces = 3;
const char* NameOf(SeenPlace place);  // "highlights"

// Of the CIELAB differences in one place; all 0 if it has no pixel.
struct PlaceError {
  double share = 0;    // of all pixels
  double squares = 0;  // of the sum of the squares of all differences
  double mean_delta_e = 0;
  double lightness = 0;  // mean of fitted - measured L
  double color = 0;      // of the sum of squares here, what more or less light would not mend
};

// How two pictures differ to the eye.
struct SeenError {
  double psnr_db = 0;       // of the encoded values, peak 1; +infinity for equal pictures
  double mean_delta_e = 0;  // CIELAB, 1976
  double delta_e_95 = 0;    // 95 % of the pixels stay below
  std::array<PlaceError, kNumPlaces> places = {};  // [SeenPlace]

  const PlaceError& at(SeenPlace place) const { return places[static_cast<size_t>(place)]; }
};

// Sums it up, pixel by pixel.
class SeenErrorSum {
 public:
  // Exposed light, which is clipped at 1 and encoded by the sRGB curve.
  void Add(const Rgb& measured, const Rgb& fitted, bool grazing);

  SeenError Total() const;

 private:
  struct Sum {
    int pixels = 0;
    double delta_e = 0, squares = 0, color_squares = 0, lightness = 0;
  };

  double encoded_squares_ = 0;
  std::vector<double> delta_e_;
  std::array<Sum, kNumPlaces> sums_ = {};
};

// How measured and fitted samples differ to the eye where they make no picture: each is a patch
// under a light of its own, as bright as rho cos theta_i. As a camera sets itself, the exposure is
// that of which the mean luminance of the measured ones, clipped at 1, is kMeanLuminance, or nearly
// 1 where so many are black that none is; 0 for a black measurement. `fitted`: [samples.size()]
SeenError CompareSamples(const BrdfSamples& samples, const std::vector<Rgb>& fitted);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_SEEN_ERROR_H_
