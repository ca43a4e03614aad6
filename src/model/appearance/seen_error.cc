#include "trilobe/model/appearance/seen_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/quantile.h"
#include "model/appearance/color.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/directions.h"

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
double ExposureOf(std::span<const SeenPatch> patches) {
  std::vector<double> luminances;
  double largest = 0, all = 0;
  for (const SeenPatch& patch : patches) {
    luminances.push_back(Luminance(patch.measured) * patch.cosines.i);
    largest = std::max(largest, luminances.back());
    all += patch.weight;
  }
  if (!(largest > 0)) return 0;
  double below = std::log2(kMeanLuminance / largest), above = below + 64;
  for (int step = 0; step < 60; ++step) {
    const double middle = (below + above) / 2, exposure = std::exp2(middle);
    double sum = 0;
    for (size_t k = 0; k < patches.size(); ++k) {
      sum += patches[k].weight * std::min(exposure * luminances[k], 1.0);
    }
    (sum < kMeanLuminance * all ? below : above) = middle;
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

void SeenErrorSum::Add(const Rgb& measured, const Rgb& fitted, bool grazing, double weight) {
  const Rgb a = Clipped(measured), b = Clipped(fitted);
  for (int c = 0; c < kChannels; ++c) {
    const double difference = EncodeSrgb(b[c]) - EncodeSrgb(a[c]);
    encoded_squares_ += weight * difference * difference;
  }
  const Lab lab_a = ToLab(a), lab_b = ToLab(b);
  const double difference = LabDifference(lab_a, lab_b);
  delta_e_.push_back(difference);
  weights_.push_back(weight);
  const bool bright = std::max(Luminance(measured), Luminance(fitted)) >= 2 * kMeanLuminance;
  const SeenPlace place = grazing  ? SeenPlace::kGrazing
                          : bright ? SeenPlace::kHighlights
                                   : SeenPlace::kRest;
  Sum& sum = sums_[static_cast<size_t>(place)];
  sum.pixels += weight;
  sum.delta_e += weight * difference;
  sum.squares += weight * difference * difference;
  // Uses the colour before clipping: clipping turns orange into yellow.
  sum.color_squares +=
      weight * difference * difference * ColorShare(ToLab(measured), ToLab(fitted));
  sum.lightness += weight * (lab_b[0] - lab_a[0]);
}

SeenError SeenErrorSum::Total() const {
  const double pixels = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  const double n = pixels > 0 ? pixels : 1;
  SeenError error;
  error.psnr_db = encoded_squares_ > 0 ? -10 * std::log10(encoded_squares_ / (n * kChannels))
                                       : std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < delta_e_.size(); ++k) error.mean_delta_e += weights_[k] * delta_e_[k] / n;
  if (!delta_e_.empty()) error.delta_e_95 = WeightedQuantile(delta_e_, weights_, 0.95);
  double squares = 0;
  for (const Sum& sum : sums_) squares += sum.squares;
  for (size_t k = 0; k < kNumPlaces; ++k) {
    const Sum& sum = sums_[k];
    if (!(sum.pixels > 0)) continue;
    error.places[k] = {.share = sum.pixels / n,
                       .squares = squares > 0 ? sum.squares / squares : 0,
                       .mean_delta_e = sum.delta_e / sum.pixels,
                       .lightness = sum.lightness / sum.pixels,
                       .color = sum.squares > 0 ? sum.color_squares / sum.squares : 0};
  }
  return error;
}

SeenError ComparePatches(std::span<const SeenPatch> patches) {
  const double exposure = ExposureOf(patches);
  const double grazing = std::cos(DegreesToRadians(kGrazingAngleDegrees));
  SeenErrorSum sum;
  for (const SeenPatch& patch : patches) {
    const double factor = exposure * patch.cosines.i;
    sum.Add(Scaled(patch.measured, factor), Scaled(patch.fitted, factor),
            std::min(patch.cosines.i, patch.cosines.o) < grazing, patch.weight);
  }
  return sum.Total();
}

SeenError CompareSamples(const BrdfSamples& samples, const std::vector<Rgb>& fitted) {
  CheckSize("fitted", fitted.size(), samples.rho.size());
  std::vector<SeenPatch> patches(fitted.size());
  for (int j = 0; j < samples.size(); ++j) {
    patches[j] = {.measured = samples.rho[j], .fitted = fitted[j], .cosines = samples.CosinesOf(j)};
  }
  return ComparePatches(patches);
}

}  // namespace trilobe
