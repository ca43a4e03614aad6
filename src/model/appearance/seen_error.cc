#include "trilobe/model/appearance/seen_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/quantile.h"
#include "model/appearance/color.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/geometry/directions.h"

namespace trilobe {
namespace {

Rgb Clipped(const Rgb& light) {
  Rgb clipped;
  for (int c = 0; c < kChannels; ++c) clipped[c] = std::min(light[c], 1.0);
  return clipped;
}

// The fraction of the squared difference of two colours that scaling the light cannot correct.
// Scaling moves (L + 16, a, b), which are sums of cube roots, along a ray.
double ColorShare(const Lab& measured, const Lab& fitted) {
  const auto length = [](const Lab& lab) { return std::hypot(lab[0] + 16, lab[1], lab[2]); };
  const double difference = LabDifference(measured, fitted);
  if (!(difference > 0)) return 0;
  const double along = (length(fitted) - length(measured)) / difference;
  return std::isfinite(along) ? std::max(1 - along * along, 0.0) : 0;
}

// [1 / luminance] The mean clipped luminance increases with the exposure.
double ExposureOf(const std::vector<double>& luminances) {
  const double largest = luminances.empty() ? 0 : std::ranges::max(luminances);
  if (!(largest > 0)) return 0;
  double below = std::log2(kMeanLuminance / largest), above = below + 64;
  for (int step = 0; step < 60; ++step) {
    const double middle = (below + above) / 2, exposure = std::exp2(middle);
    double sum = 0;
    for (const double y : luminances) sum += std::min(exposure * y, 1.0);
    (sum < kMeanLuminance * static_cast<double>(luminances.size()) ? below : above) = middle;
  }
  return std::exp2(below);
}

Rgb Scaled(const Rgb& rho, double factor) {
  Rgb light;
  for (int c = 0; c < kChannels; ++c) light[c] = std::max(rho[c], 0.0) * factor;
  return light;
}

}  // namespace

const char* NameOf(SeenPlace place) {
  switch (place) {
    case SeenPlace::kHighlights:
      return "highlights";
    case SeenPlace::kGrazing:
      return "grazing";
    case SeenPlace::kRest:
      return "rest";
  }
  return "";
}

void SeenErrorSum::Add(const Rgb& measured, const Rgb& fitted, bool grazing) {
  const Rgb a = Clipped(measured), b = Clipped(fitted);
  for (int c = 0; c < kChannels; ++c) {
    const double difference = EncodeSrgb(b[c]) - EncodeSrgb(a[c]);
    encoded_squares_ += difference * difference;
  }
  const Lab lab_a = ToLab(a), lab_b = ToLab(b);
  const double difference = LabDifference(lab_a, lab_b);
  delta_e_.push_back(difference);
  const bool bright = std::max(Luminance(measured), Luminance(fitted)) >= 2 * kMeanLuminance;
  const SeenPlace place = grazing  ? SeenPlace::kGrazing
                          : bright ? SeenPlace::kHighlights
                                   : SeenPlace::kRest;
  Sum& sum = sums_[static_cast<size_t>(place)];
  ++sum.pixels;
  sum.delta_e += difference;
  sum.squares += difference * difference;
  // By the colour before clipping: clipping turns orange into yellow.
  sum.color_squares += difference * difference * ColorShare(ToLab(measured), ToLab(fitted));
  sum.lightness += lab_b[0] - lab_a[0];
}

SeenError SeenErrorSum::Total() const {
  const auto n = static_cast<double>(std::max<size_t>(delta_e_.size(), 1));
  SeenError error;
  error.psnr_db = encoded_squares_ > 0 ? -10 * std::log10(encoded_squares_ / (n * kChannels))
                                       : std::numeric_limits<double>::infinity();
  for (const double difference : delta_e_) error.mean_delta_e += difference / n;
  if (!delta_e_.empty()) {
    std::vector<double> differences = delta_e_;
    error.delta_e_95 = Quantile(&differences, 0.95);
  }
  double squares = 0;
  for (const Sum& sum : sums_) squares += sum.squares;
  for (size_t k = 0; k < kNumPlaces; ++k) {
    const Sum& sum = sums_[k];
    if (sum.pixels == 0) continue;
    error.places[k] = {.share = sum.pixels / n,
                       .squares = squares > 0 ? sum.squares / squares : 0,
                       .mean_delta_e = sum.delta_e / sum.pixels,
                       .lightness = sum.lightness / sum.pixels,
                       .color = sum.squares > 0 ? sum.color_squares / sum.squares : 0};
  }
  return error;
}

SeenError CompareSamples(const BrdfSamples& samples, const std::vector<Rgb>& fitted) {
  CheckSize("fitted", fitted.size(), samples.rho.size());
  std::vector<double> luminances;
  for (int j = 0; j < samples.size(); ++j) {
    luminances.push_back(Luminance(samples.rho[j]) * samples.CosinesOf(j).i);
  }
  const double exposure = ExposureOf(luminances);
  const double grazing = std::cos(DegreesToRadians(kGrazingAngleDegrees));
  SeenErrorSum sum;
  for (int j = 0; j < samples.size(); ++j) {
    const Cosines cosines = samples.CosinesOf(j);
    sum.Add(Scaled(samples.rho[j], exposure * cosines.i), Scaled(fitted[j], exposure * cosines.i),
            std::min(cosines.i, cosines.o) < grazing);
  }
  return sum.Total();
}

}  // namespace trilobe
