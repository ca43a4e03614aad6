#include "fit/export/usd_material.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fit/export/nearest_open_pbr.h"
#include "tests/model/materials.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

TEST(UsdMaterial, HasWhatThePreviewSurfaceTakes) {
  OpenPbr material = {.base_color = {0.95, 0.64, 0.54},
                      .base_metalness = 1,
                      .specular_roughness = 0.387,
                      .specular_ior = 1.5};
  const std::string text = FormatUsd(
      material, {.name = "2 coppers", .made = "of \"x\"", .error = "far off", .lost = "much"});
  EXPECT_THAT(text, testing::StartsWith("#usda 1.0\n"));
  EXPECT_THAT(text, HasSubstr("doc = \"\"\"of \\\"x\\\"\nfar off\nmuch\"\"\""));
  EXPECT_THAT(text, HasSubstr("def Material \"_2_coppers\""));
  EXPECT_THAT(text, HasSubstr("material:binding = </World/Looks/_2_coppers>"));
  EXPECT_THAT(text, HasSubstr("inputs:diffuseColor = (0.95, 0.64, 0.54)"));
  EXPECT_THAT(text, HasSubstr("inputs:metallic = 1\n"));
  EXPECT_THAT(text, HasSubstr("inputs:roughness = 0.387\n"));
  // A metal has no use for it.
  EXPECT_THAT(text, testing::Not(HasSubstr("inputs:ior")));
  material.base_metalness = 0;
  EXPECT_THAT(FormatUsd(material, {.name = "x"}), HasSubstr("inputs:ior = 1.5\n"));
}

// It has neither a tint nor a coat, nor two roughnesses.
TEST(UsdMaterial, IsOfFewerClosures) {
  for (const ModelSpec& spec :
       {ModelSpec::SharedFactors(2), ModelSpec::AnisotropicFor(1, 12, 1.3)}) {
    const NearestOpenPbr nearest =
        FindNearestOpenPbr(AnalyticModel(spec, 0.2, 0.3), kPi / 2, {.lights = 12, .size = 24},
                           StandardShading::kPreviewSurface);
    EXPECT_EQ(nearest.material.coat_weight, 0);
    EXPECT_EQ(nearest.material.specular_color, (Rgb{1, 1, 1}));
    EXPECT_EQ(nearest.material.specular_roughness_anisotropy, 0);
    EXPECT_EQ(nearest.material.base_diffuse_roughness, 0);
    EXPECT_GT(nearest.error.psnr_db, 20);
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
