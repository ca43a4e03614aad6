#include "fit/open_pbr/open_pbr.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/model/evaluate/materials.h"
#include "tests/test_util.h"
#include "trilobe/core/geometry/directions.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Share of the light from theta_o that is reflected, by half vectors at even steps of the fourth
// root of y = sin^2 theta_h about a highlight, and their azimuths.
Rgb AlbedoOf(const OpenPbrBrdf& brdf, double theta_o) {
  constexpr int kAcross = 500, kAround = 120;
  const Direction wo = DirectionAt(theta_o, 0);
  Rgb albedo{};
  for (int k = 0; k < kAcross; ++k) {
    const double u = (k + 0.5) / kAcross, theta_h = u * u * kPi / 2;
    for (int a = 0; a < kAround; ++a) {
      const Direction h = DirectionAt(theta_h, 2 * kPi * (a + 0.5) / kAround);
      const double cosine = Dot(wo, h);
      Direction wi{};
      for (int axis = 0; axis < 3; ++axis) wi[axis] = 2 * cosine * h[axis] - wo[axis];
      if (!(cosine > 0) || !(wi[2] > 0)) continue;
      const double area = std::sin(theta_h) * kPi * u / kAcross * 2 * kPi / kAround * 4 * cosine;
      const Rgb value = brdf({wi, wo});
      for (int c = 0; c < kChannels; ++c) albedo[c] += value[c] * wi[2] * area;
    }
  }
  return albedo;
}

OpenPbr Metal(double roughness) {
  return {.base_color = {1, 1, 1}, .base_metalness = 1, .specular_roughness = roughness};
}

TEST(OpenPbr, AMatSurfaceIsLambertian) {
  const OpenPbrBrdf brdf({.base_color = {0.5, 0.2, 0}, .specular_ior = 1});
  for (const double theta : {0.0, 0.5, 1.2}) {
    const Rgb value = brdf({DirectionAt(theta, 1), DirectionAt(1 - theta / 2, 3)});
    EXPECT_NEAR(value[0], 0.5 / kPi, 1e-9);
    EXPECT_NEAR(value[1], 0.2 / kPi, 1e-9);
    EXPECT_NEAR(value[2], 0, 1e-9);
  }
}

TEST(OpenPbr, WhiteThingsReflectAllLight) {
  for (const double roughness : {0.1, 0.4, 0.8, 1.0}) {
    for (const double theta : {0.1, 0.8, 1.3}) {
      EXPECT_NEAR(AlbedoOf(OpenPbrBrdf(Metal(roughness)), theta)[0], 1, 0.03)
          << roughness << " " << theta;
      const OpenPbrBrdf chalk({.base_color = {1, 1, 1},
                               .base_diffuse_roughness = roughness,
                               .specular_roughness = roughness});
      EXPECT_NEAR(AlbedoOf(chalk, theta)[0], 1, 0.04) << roughness << " " << theta;
    }
  }
}

TEST(OpenPbr, NothingReflectsMoreThanItGets) {
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const OpenPbrBrdf brdf({.base_color = {random.Uniform(), random.Uniform(), 1},
                            .base_diffuse_roughness = random.Uniform(),
                            .base_metalness = random.Uniform(),
                            .specular_color = {random.Uniform(), random.Uniform(), 1},
                            .specular_roughness = random.Uniform(0.1, 1),
                            .specular_roughness_anisotropy = random.Uniform(0, 0.5),
                            .specular_ior = random.Uniform(1, 2.5),
                            .coat_weight = random.Uniform(),
                            .coat_roughness = random.Uniform(0.1, 1)});
    for (const double share : AlbedoOf(brdf, random.Uniform(0, 1.4))) {
      EXPECT_GE(share, 0);
      EXPECT_LE(share, 1.06);
    }
  }
}

TEST(OpenPbr, TheTintIsSeenAt82Degrees) {
  OpenPbr gold = Metal(0.05);
  gold.base_color = {1, 0.7, 0.3};
  gold.specular_color = {1, 0.5, 0.5};
  const OpenPbr white = Metal(0.05);
  const double theta = std::acos(1.0 / 7);
  const DirectionPair along = {DirectionAt(theta, 0), DirectionAt(theta, kPi)};
  const DirectionPair across = {DirectionAt(0.01, 0), DirectionAt(0.01, kPi)};
  const Rgb grazing = OpenPbrBrdf(gold)(along), of_white = OpenPbrBrdf(white)(along);
  EXPECT_NEAR(grazing[0] / of_white[0], 1, 0.01);
  const double schlick = 0.7 + 0.3 * std::pow(6.0 / 7, 5);
  EXPECT_NEAR(grazing[1] / of_white[1], schlick / 2, 0.02);
  EXPECT_NEAR(OpenPbrBrdf(gold)(across)[2] / OpenPbrBrdf(white)(across)[2], 0.3, 0.01);
}

TEST(OpenPbr, TurnsWithItsTangent) {
  OpenPbr brushed = Metal(0.4);
  brushed.specular_roughness_anisotropy = 0.8;
  const DirectionPair pair = {DirectionAt(0.6, 0.4), DirectionAt(0.3, 1.0)};
  const double turn = 0.7;
  const DirectionPair turned = {DirectionAt(0.6, 0.4 + turn), DirectionAt(0.3, 1.0 + turn)};
  const double before = OpenPbrBrdf(brushed)(pair)[0];
  EXPECT_GT(std::abs(OpenPbrBrdf(brushed)(turned)[0] / before - 1), 0.1);
  brushed.turn = turn;
  EXPECT_NEAR(OpenPbrBrdf(brushed)(turned)[0], before, 1e-9 * before);
}

TEST(OpenPbr, IsDarkBelowTheSurface) {
  const OpenPbrBrdf brdf({});
  EXPECT_EQ(brdf({{0, 0, -1}, {0, 0, 1}}), (Rgb{0, 0, 0}));
  EXPECT_EQ(brdf({{0, 0, 1}, {1, 0, 0}}), (Rgb{0, 0, 0}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
