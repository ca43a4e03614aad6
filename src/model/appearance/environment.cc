#include "trilobe/model/appearance/environment.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/radical_inverse.h"
#include "model/appearance/color.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// `row` and `column` may be fractional.
Direction DirectionAt(const Environment& environment, double row, double column) {
  const double theta = kPi * row / environment.height;
  const double phi = 2 * kPi * (column / environment.width - 0.5);
  return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

double SmoothStep(double from, double end, double x) {
  const double t = std::clamp((x - from) / (end - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// A soft-edged rectangle on the sphere of directions: latitude and longitude of its centre and half
// its sides [degrees].
struct AreaLight {
  double latitude, longitude, half_height, half_width;
  Rgb radiance;
};
constexpr AreaLight kAreaLights[] = {
    {35, -125, 18, 14, {9.0, 8.2, 7.0}},  // key, warm, upper left before the object
    {10, 100, 35, 8, {2.2, 2.6, 3.4}},    // fill, cool, from the right
    {15, 20, 10, 20, {4.0, 3.6, 4.4}},    // from behind: grazing light
};
constexpr double kSunLatitude = 55, kSunLongitude = 150, kSunRadius = 3;  // [degrees]
constexpr Rgb kSun = {220, 200, 170};

Rgb StudioRadiance(double latitude, double longitude) {
  Rgb radiance{};
  const auto add = [&](const Rgb& color, double scale) {
    for (int c = 0; c < kChannels; ++c) radiance[c] += scale * color[c];
  };
  const double sky = SmoothStep(-3, 3, latitude);
  const double zenith = SmoothStep(0, 90, latitude);
  add({0.25, 0.45, 0.9}, sky * zenith);
  add({0.8, 0.85, 0.9}, sky * (1 - zenith));
  add({0.12, 0.1, 0.08}, 1 - sky);
  const auto around = [&](double middle) { return std::remainder(longitude - middle, 360.0); };
  for (const AreaLight& light : kAreaLights) {
    const double up = std::abs(latitude - light.latitude) / light.half_height;
    const double side = std::abs(around(light.longitude)) / light.half_width;
    add(light.radiance, 1 - SmoothStep(0.9, 1.1, std::max(up, side)));
  }
  const double distance = std::hypot(
      latitude - kSunLatitude, around(kSunLongitude) * std::cos(DegreesToRadians(kSunLatitude)));
  add(kSun, 1 - SmoothStep(0.8 * kSunRadius, 1.2 * kSunRadius, distance));
  return radiance;
}

Environment MakeStudio() {
  Environment studio{"studio", 512, 256, {}};
  for (int row = 0; row < studio.height; ++row) {
    for (int column = 0; column < studio.width; ++column) {
      studio.radiance.push_back(StudioRadiance(90 - 180 * (row + 0.5) / studio.height,
                                               360 * ((column + 0.5) / studio.width) - 180));
    }
  }
  return studio;
}

// Position in a running sum (with its total last) at which it first exceeds a share of the total,
// with the fraction within the entry. The fraction stays far enough below 1 that rounding does not
// lead to the next entry, which may have no light.
double Find(const double* sums, int size, double share) {
  const double wanted = share * sums[size - 1];
  const int i =
      std::min(static_cast<int>(std::upper_bound(sums, sums + size, wanted) - sums), size - 1);
  const double before = i > 0 ? sums[i - 1] : 0;
  return i + std::min((wanted - before) / (sums[i] - before), 1 - 0x1p-20);
}

}  // namespace

const Environment& StudioEnvironment() {
  static const Environment studio = MakeStudio();
  return studio;
}

void CheckEnvironment(const Environment& environment) {
  const int width = environment.width, height = environment.height;
  if (width < 1 || height < 1 ||
      environment.radiance.size() != static_cast<size_t>(width) * height) {
    throw ErrorIn(ErrorKind::kMismatch, environment.name,
                  "an environment of " + std::to_string(width) + " x " + std::to_string(height) +
                      " pixels with the radiance of " + std::to_string(environment.radiance.size()))
        .About("radiance", environment.radiance.size());
  }
  for (const Rgb& pixel : environment.radiance) {
    for (const double x : pixel) {
      if (x >= 0 && std::isfinite(x)) continue;
      throw ErrorIn(
          ErrorKind::kRange, environment.name,
          "the radiance of a pixel is " + std::to_string(x) + "; it must be finite and 0 or more")
          .About("radiance", x);
    }
  }
}

std::vector<Light> DrawLights(const Environment& environment, int count) {
  CheckEnvironment(environment);
  CheckNumber("the number of lights", count, count >= 1, "1 or more");
  const int width = environment.width, height = environment.height;
  std::vector<double> sums(environment.radiance.size());  // along each row
  std::vector<double> row_sums(height);                   // over whole rows
  for (int row = 0; row < height; ++row) {
    // Pixels of a row cover d omega = d phi (cos theta_top - cos theta_bottom).
    const double solid_angle =
        2 * kPi / width * (std::cos(kPi * row / height) - std::cos(kPi * (row + 1) / height));
    double sum = 0;
    for (int column = 0; column < width; ++column) {
      sum += solid_angle * Luminance(environment.radiance[row * width + column]);
      sums[row * width + column] = sum;
    }
    row_sums[row] = sum + (row > 0 ? row_sums[row - 1] : 0);
  }
  const double total = row_sums.back();
  if (!(total > 0 && std::isfinite(total))) {
    throw ErrorIn(ErrorKind::kData, environment.name,
                  "the environment has no light; give one that is not black")
        .About("radiance", total);
  }
  std::vector<Light> lights;
  for (int k = 0; k < count; ++k) {
    const double row = Find(row_sums.data(), height, (k + 0.5) / count);
    const int r = std::min(static_cast<int>(row), height - 1);
    const double column = Find(&sums[r * width], width, RadicalInverse(2, static_cast<size_t>(k)));
    const int pixel = r * width + std::min(static_cast<int>(column), width - 1);
    Light light{DirectionAt(environment, row, column), environment.radiance[pixel]};
    const double luminance = Luminance(light.irradiance);
    for (double& x : light.irradiance) x *= total / count / luminance;
    lights.push_back(light);
  }
  return lights;
}

}  // namespace trilobe
