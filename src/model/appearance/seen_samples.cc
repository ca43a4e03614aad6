#include "model/appearance/seen_samples.h"

#include <algorithm>
#include <cmath>

#include "model/appearance/color.h"
#include "trilobe/core/geometry/directions.h"

namespace trilobe {
namespace {

// [1 / luminance] The mean of the clipped luminances grows with it.
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

SeenError CompareSamples(const BrdfSamples& samples, const std::vector<Rgb>& fitted) {
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
