#include "fit/export/nearest_open_pbr.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/error_of.h"
#include "tests/model/materials.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

const AppearanceOptions kSmall = {.lights = 24, .size = 32};

FactorModel Mat(const Rgb& albedo) {
  FactorModel model(ModelSpec::SharedFactors(1));
  for (int c = 0; c < kChannels; ++c) model.d()[c] = albedo[c] / kPi;
  return model;
}

TEST(FindNearestOpenPbr, FindsAMatMaterial) {
  const NearestOpenPbr nearest = FindNearestOpenPbr(Mat({0.6, 0.3, 0.1}), kPi / 2, kSmall);
  EXPECT_LT(nearest.error.mean_delta_e, 1);
  EXPECT_NEAR(nearest.material.base_color[0], 0.6, 0.1);
  EXPECT_NEAR(nearest.material.base_color[2], 0.1, 0.05);
}

TEST(FindNearestOpenPbr, FindsTheRoughnessOfAHighlight) {
  const FactorModel model = AnalyticModel(ModelSpec::SharedFactors(1), 0.25, 0.3);
  const NearestOpenPbr nearest = FindNearestOpenPbr(model, kPi / 2, kSmall);
  EXPECT_LT(nearest.error.mean_delta_e, 2);
  EXPECT_TRUE(std::isfinite(nearest.error.psnr_db));
  EXPECT_NEAR(nearest.material.specular_roughness, 0.5, 0.05);
}

// What one GGX lobe does is one closure of an engine's material.
TEST(FindNearestOpenPbr, TakesTheFewestClosures) {
  const FactorModel model = AnalyticModel(ModelSpec::SharedFactors(1), 0.15, 0);
  for (const StandardShading shading : {StandardShading::kOpenPbr, StandardShading::kGltf}) {
    const OpenPbr found = FindNearestOpenPbr(model, kPi / 2, kSmall, shading).material;
    EXPECT_NEAR(found.specular_roughness, std::sqrt(0.15), 0.02);
    EXPECT_EQ(found.coat_weight, 0);
    EXPECT_EQ(found.base_diffuse_roughness, 0);
  }
}

TEST(FindNearestOpenPbr, TakesAnisotropicModels) {
  const FactorModel model = AnalyticModel(ModelSpec::Anisotropic(1), 0.2, 0.1);
  const NearestOpenPbr nearest = FindNearestOpenPbr(model, DegreesToRadians(75), kSmall);
  EXPECT_GT(nearest.material.specular_roughness_anisotropy, 0.2);
  EXPECT_LT(nearest.error.mean_delta_e, 5);
}

TEST(FindNearestOpenPbr, RefusesABlackModel) {
  EXPECT_THAT(ErrorOf([&] {
                FindNearestOpenPbr(Mat({0, 0, 0}), kPi / 2, kSmall);
              }),
              IsError(ErrorKind::kData, {.key = "model", .value = "black"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
