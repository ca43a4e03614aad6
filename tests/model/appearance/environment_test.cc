#include "trilobe/model/appearance/environment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "model/appearance/color.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

Environment Black(int width, int height) {
  return {"test", width, height, std::vector<Rgb>(static_cast<size_t>(width) * height)};
}

Environment OnePixel(int row, int column, const Rgb& radiance) {
  Environment environment = Black(16, 8);
  environment.radiance[row * 16 + column] = radiance;
  return environment;
}

// Half of the pixels black, the others of all colours and very different strength.
Environment Speckled(int width, int height) {
  Random random(1);
  Environment environment = Black(width, height);
  for (Rgb& radiance : environment.radiance) {
    const bool black = random.Uniform() < 0.5;
    const double strength = random.LogNormal(2);
    for (double& x : radiance) x = black ? 0 : strength * random.LogNormal(0.5);
  }
  return environment;
}

// Row and column of a direction in the picture, by the header's convention.
double RowOf(const Environment& environment, const Direction& d) {
  return std::acos(std::clamp(d[1], -1.0, 1.0)) / kPi * environment.height;
}
double ColumnOf(const Environment& environment, const Direction& d) {
  return (std::atan2(d[0], -d[2]) / (2 * kPi) + 0.5) * environment.width;
}

double SolidAngle(const Environment& environment, int row) {
  const double top = kPi * row / environment.height, bottom = kPi * (row + 1) / environment.height;
  return 2 * kPi / environment.width * (std::cos(top) - std::cos(bottom));
}

double TotalLuminance(const Environment& environment) {
  double sum = 0;
  for (int k = 0; k < environment.width * environment.height; ++k) {
    sum += SolidAngle(environment, k / environment.width) * Luminance(environment.radiance[k]);
  }
  return sum;
}

std::optional<Error> ErrorFrom(const Environment& environment) {
  return ErrorOf([&] { DrawLights(environment, 4); });
}

TEST(EnvironmentTest, DrawsTheSameLightsEachTime) {
  const Environment environment = Speckled(32, 16);
  const std::vector<Light> once = DrawLights(environment, 50), again = DrawLights(environment, 50);
  ASSERT_EQ(once.size(), 50U);
  for (size_t k = 0; k < once.size(); ++k) {
    EXPECT_EQ(once[k].direction, again[k].direction);
    EXPECT_EQ(once[k].irradiance, again[k].irradiance);
  }
}

TEST(EnvironmentTest, LightsHaveEqualLuminanceAndAllOfIt) {
  for (const Environment& environment : {Speckled(32, 16), StudioEnvironment()}) {
    const double total = TotalLuminance(environment);
    for (const int count : {1, 7, 600}) {
      for (const Light& light : DrawLights(environment, count)) {
        ASSERT_NEAR(Luminance(light.irradiance), total / count, 1e-11 * total / count);
        const Direction& d = light.direction;
        ASSERT_NEAR(std::hypot(d[0], d[1], d[2]), 1, 1e-14);
      }
    }
  }
}

// Each component of the irradiance vector and each colour, as sums over all pixels have them.
TEST(EnvironmentTest, LightsStandForTheWholeMap) {
  const Environment& environment = StudioEnvironment();
  Rgb color{}, light_color{};
  Direction vector{}, light_vector{};
  for (int row = 0; row < environment.height; ++row) {
    for (int column = 0; column < environment.width; ++column) {
      const Rgb& radiance = environment.radiance[row * environment.width + column];
      const double solid_angle = SolidAngle(environment, row);
      const double theta = kPi * (row + 0.5) / environment.height;
      const double phi = 2 * kPi * ((column + 0.5) / environment.width - 0.5);
      const Direction d = {std::sin(theta) * std::sin(phi), std::cos(theta),
                           -std::sin(theta) * std::cos(phi)};
      for (int k = 0; k < 3; ++k) {
        color[k] += solid_angle * radiance[k];
        vector[k] += solid_angle * Luminance(radiance) * d[k];
      }
    }
  }
  for (const Light& light : DrawLights(environment, 4000)) {
    for (int k = 0; k < 3; ++k) {
      light_color[k] += light.irradiance[k];
      light_vector[k] += Luminance(light.irradiance) * light.direction[k];
    }
  }
  const double total = Luminance(color);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(light_color[k], color[k], 2e-3 * total) << k;
    EXPECT_NEAR(light_vector[k], vector[k], 2e-3 * total) << k;
  }
}

TEST(EnvironmentTest, LightsComeFromWhereThereIsLight) {
  const Environment environment = Speckled(64, 32);
  for (const Light& light : DrawLights(environment, 20000)) {
    const int row = static_cast<int>(RowOf(environment, light.direction));
    const int column = static_cast<int>(ColumnOf(environment, light.direction));
    const Rgb& radiance = environment.radiance[row * 64 + column];
    ASSERT_GT(Luminance(radiance), 0) << row << ", " << column;
    // In that pixel's colour.
    for (int c = 0; c < kChannels; ++c) {
      ASSERT_NEAR(light.irradiance[c] * Luminance(radiance),
                  radiance[c] * Luminance(light.irradiance), 1e-12);
    }
  }
}

TEST(EnvironmentTest, OneBrightPixelHasAllLights) {
  const Rgb radiance = {3, 2, 7};
  for (const auto& [row, column] : {std::pair(0, 0), std::pair(3, 8), std::pair(7, 15)}) {
    const Environment environment = OnePixel(row, column, radiance);
    Rgb sum{};
    double first_row = 8, last_row = 0;
    for (const Light& light : DrawLights(environment, 64)) {
      const double y = RowOf(environment, light.direction);
      const double x = ColumnOf(environment, light.direction);
      EXPECT_TRUE(y > row && y < row + 1 && x >= column - 1e-12 && x < column + 1)
          << y << ", " << x;
      for (int c = 0; c < kChannels; ++c) sum[c] += light.irradiance[c];
      first_row = std::min(first_row, y);
      last_row = std::max(last_row, y);
    }
    EXPECT_GT(last_row - first_row, 0.9);  // all over it
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(sum[c], radiance[c] * SolidAngle(environment, row), 1e-12);
    }
  }
}

// The middle column is behind the object, the outer ones are behind the eye.
TEST(EnvironmentTest, RowsGoDownAndColumnsAroundToTheRight) {
  const auto direction = [](int row, int column) {
    return DrawLights(OnePixel(row, column, {1, 1, 1}), 1).at(0).direction;
  };
  for (const int column : {7, 8}) EXPECT_LT(direction(4, column)[2], -0.9) << column;
  for (const int column : {0, 15}) EXPECT_GT(direction(4, column)[2], 0.9) << column;
  for (const int column : {11, 12}) EXPECT_GT(direction(4, column)[0], 0.9) << column;
  for (const int column : {3, 4}) EXPECT_LT(direction(4, column)[0], -0.9) << column;
  EXPECT_GT(direction(0, 5)[1], 0.9);
  EXPECT_LT(direction(7, 5)[1], -0.9);
  EXPECT_GT(direction(3, 5)[1], 0);
}

TEST(EnvironmentTest, NoLightIsAnError) {
  EXPECT_NO_THROW(DrawLights(Speckled(16, 8), 4));
  EXPECT_THAT(ErrorFrom(Black(16, 8)),
              IsError(ErrorKind::kData, {.file = "test", .key = "radiance", .value = "0"}));
  for (const double bad :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(ErrorFrom(OnePixel(2, 3, {1, bad, 1})),
                IsError(ErrorKind::kRange, {.file = "test", .key = "radiance"}));
  }
}

TEST(EnvironmentTest, TheStudioHasLightFromAllSides) {
  const Environment& studio = StudioEnvironment();
  ASSERT_EQ(studio.radiance.size(), static_cast<size_t>(studio.width) * studio.height);
  double dimmest = 1e9, brightest = 0;
  for (const Rgb& radiance : studio.radiance) {
    ASSERT_TRUE(std::ranges::all_of(radiance, [](double x) { return std::isfinite(x) && x >= 0; }));
    dimmest = std::min(dimmest, Luminance(radiance));
    brightest = std::max(brightest, Luminance(radiance));
  }
  EXPECT_GT(dimmest, 0.05);
  EXPECT_GT(brightest, 100);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
