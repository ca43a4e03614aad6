#include "fit/export/gltf_material.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/files/own_mark.h"
#include "tests/model/materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// Appendix B of glTF 2.0, as it stands there, for one channel.
double Literal(double color, double metallic, double roughness, const DirectionPair& pair) {
  Direction h;
  for (int k = 0; k < 3; ++k) h[k] = pair.wi[k] + pair.wo[k];
  const double length = std::sqrt(Dot(h, h));
  for (double& x : h) x /= length;
  const double alpha2 = std::pow(roughness, 4);
  const double n_h = h[2], n_l = pair.wi[2], n_v = pair.wo[2], v_h = Dot(pair.wo, h);
  const double d = alpha2 / (kPi * std::pow(n_h * n_h * (alpha2 - 1) + 1, 2));
  const double v = 1 / ((n_l + std::sqrt(alpha2 + (1 - alpha2) * n_l * n_l)) *
                        (n_v + std::sqrt(alpha2 + (1 - alpha2) * n_v * n_v)));
  // The separable form of the Smith term; the correlated one is at most as large again.
  const double correlated = 0.5 / (n_l * std::sqrt(alpha2 + (1 - alpha2) * n_v * n_v) +
                                   n_v * std::sqrt(alpha2 + (1 - alpha2) * n_l * n_l));
  EXPECT_GE(correlated, v * (1 - 1e-12));
  const double fifth = std::pow(1 - v_h, 5);
  const double metal = correlated * d * (color + (1 - color) * fifth);
  const double fresnel = 0.04 + 0.96 * fifth;
  const double plastic = (1 - fresnel) * color / kPi + fresnel * correlated * d;
  return metallic * metal + (1 - metallic) * plastic;
}

TEST(GltfBrdf, IsTheAppendixs) {
  Random random(5);
  for (int k = 0; k < 200; ++k) {
    const double metallic = k % 3 == 0 ? 1 : random.Uniform(), roughness = random.Uniform(0.1, 1);
    const OpenPbr material = {.base_color = {random.Uniform(), random.Uniform(), random.Uniform()},
                              .base_metalness = metallic,
                              .specular_roughness = roughness};
    const DirectionPair pair = {DirectionAt(random.Uniform(0, 1.5), random.Uniform(0, 6)),
                                DirectionAt(random.Uniform(0, 1.5), random.Uniform(0, 6))};
    const Rgb value = GltfBrdf(material)(pair);
    for (int c = 0; c < kChannels; ++c) {
      const double expected = Literal(material.base_color[c], metallic, roughness, pair);
      EXPECT_NEAR(value[c], expected, 1e-9 * (1 + expected));
    }
  }
  EXPECT_EQ(GltfBrdf({})({{0, 0, 1}, {0, 1, 0}}), Rgb{});
}

TEST(GltfBrdf, ACoatDimsWhatIsBelowAndAnisotropyTurns) {
  const DirectionPair mirror = {DirectionAt(0.3, 0), DirectionAt(0.3, kPi)};
  const DirectionPair aside = {DirectionAt(0.3, 0), DirectionAt(0.9, 1)};
  const OpenPbr bare = {.base_color = {0.5, 0.5, 0.5}, .specular_roughness = 0.8};
  OpenPbr coated = bare;
  coated.coat_weight = 1;
  coated.coat_roughness = 0.1;
  EXPECT_GT(GltfBrdf(coated)(mirror)[0], 10 * GltfBrdf(bare)(mirror)[0]);
  EXPECT_LT(GltfBrdf(coated)(aside)[0], GltfBrdf(bare)(aside)[0]);

  OpenPbr brushed = {
      .base_metalness = 1, .specular_roughness = 0.4, .specular_roughness_anisotropy = 0.8};
  const DirectionPair along = {DirectionAt(0, 0), DirectionAt(0.8, 0)};
  const DirectionPair across = {DirectionAt(0, 0), DirectionAt(0.8, kPi / 2)};
  EXPECT_GT(GltfBrdf(brushed)(along)[0], GltfBrdf(brushed)(across)[0]);
  const double before = GltfBrdf(brushed)(along)[0];
  brushed.turn = kPi / 2;
  EXPECT_NEAR(GltfBrdf(brushed)(across)[0], before, 1e-9 * before);
}

TEST(FormatGltf, IsADocumentThatCanBeLookedAt) {
  const OpenPbr material = {
      .base_color = {0.9, 0.6, 0.5}, .base_metalness = 1, .specular_roughness = 0.387};
  const std::string text = FormatGltf(material, {.name = "x", .made = "found by trilobe 1"});
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["asset"]["version"], "2.0");
  EXPECT_FALSE(json.contains("extensionsUsed"));
  const auto& metal = json["materials"][0]["pbrMetallicRoughness"];
  EXPECT_THAT(metal["baseColorFactor"], ElementsAre(0.9, 0.6, 0.5, 1));
  EXPECT_EQ(metal["roughnessFactor"], 0.387);
  EXPECT_EQ(metal["metallicFactor"], 1);
  EXPECT_TRUE(SaysOwn(text));
  // Views fill the buffer, and accessors their views.
  size_t end = 0;
  for (const auto& view : json["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"].get<size_t>() % 4, 0);
    EXPECT_EQ(view["byteOffset"].get<size_t>(), end);
    end = view["byteOffset"].get<size_t>() + view["byteLength"].get<size_t>();
    end += (4 - end % 4) % 4;
  }
  EXPECT_EQ(json["buffers"][0]["byteLength"], end);
  const std::string uri = json["buffers"][0]["uri"];
  EXPECT_EQ(uri.size() - uri.find(',') - 1, (end + 2) / 3 * 4);
  const size_t widths[] = {12, 16, 8, 2};
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(json["accessors"][k]["count"].get<size_t>() * widths[k],
              json["bufferViews"][k]["byteLength"].get<size_t>());
  }
  EXPECT_EQ(json["accessors"][3]["count"], 3 * 2 * 64 * 31);
}

TEST(FormatGltf, HasTheExtensionsThatItNeeds) {
  OpenPbr material = {.specular_color = {0.5, 1, 1},
                      .specular_roughness_anisotropy = 0.3,
                      .specular_ior = 1.7,
                      .coat_weight = 0.5,
                      .coat_roughness = 0.2,
                      .turn = 0.1};
  const auto json = nlohmann::json::parse(FormatGltf(material, {.name = "x"}));
  EXPECT_THAT(json["extensionsUsed"],
              ElementsAre("KHR_materials_ior", "KHR_materials_specular", "KHR_materials_clearcoat",
                          "KHR_materials_anisotropy"));
  const auto& extensions = json["materials"][0]["extensions"];
  EXPECT_EQ(extensions["KHR_materials_ior"]["ior"], 1.7);
  EXPECT_EQ(extensions["KHR_materials_anisotropy"]["anisotropyRotation"], 0.1);
  EXPECT_FALSE(SaysOwn(FormatGltf(material, {.name = "x", .made = "by hand"})));
  EXPECT_THAT(EngineText(material), HasSubstr("clearcoatFactor 0.5"));
  EXPECT_THAT(EngineText({.base_metalness = 1, .specular_ior = 2}), Not(HasSubstr("ior")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
