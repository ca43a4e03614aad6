#include "fit/export/open_pbr.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/model/materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"

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

using testing::HasSubstr;
using testing::Not;

const MaterialNotes kNotes = {.name = "2 <b> \"c\"",
                              .made = "made of a & b < \"c\"\n",
                              .error = "Delta E is 1",
                              .lost = "nothing\xff"};

TEST(FormatMaterialX, NamesAndEscapes) {
  const std::string text = FormatMaterialX({.base_color = {0.1, 0.25, 1e-7}}, kNotes);
  EXPECT_THAT(text, HasSubstr("<surfacematerial name=\"material_2__b___c_\""));
  EXPECT_THAT(text,
              HasSubstr("doc=\"made of a &amp; b &lt; &quot;c&quot; ; Delta E is 1; nothing"));
  EXPECT_THAT(text, HasSubstr("\"base_color\" type=\"color3\" value=\"0.1, 0.25, 1e-07\""));
  EXPECT_THAT(text, Not(HasSubstr("geometry_tangent")));
  // Every element that is opened is closed.
  EXPECT_EQ(std::ranges::count(text, '<'), std::ranges::count(text, '>'));
}

TEST(FormatMaterialX, TurnsTheTangent) {
  const std::string text = FormatMaterialX({.specular_roughness_anisotropy = 0.5, .turn = kPi / 2},
                                           {.name = "x", .made = "", .error = "", .lost = ""});
  EXPECT_THAT(text, HasSubstr("name=\"amount\" type=\"float\" value=\"90\""));
  EXPECT_THAT(text, HasSubstr("\"geometry_tangent\" type=\"vector3\" nodename=\"x_turned\""));
}

TEST(FormatPrincipled, HasTheInputsOfTheNode) {
  OpenPbr material;
  material.specular_roughness = 0.4;
  material.coat_weight = 0.3;
  material.base_color = {0.1, 0.2, 0.3};
  const nlohmann::json json = nlohmann::json::parse(FormatPrincipled(material, kNotes));
  EXPECT_EQ(json["format"], "blender-principled");
  const nlohmann::json& inputs = json["inputs"];
  EXPECT_EQ(inputs["Base Color"], (nlohmann::json{0.1, 0.2, 0.3, 1}));
  EXPECT_NEAR(inputs["Roughness"], 0.4, 1e-9);
  EXPECT_NEAR(inputs["Coat Weight"], 0.3, 1e-9);
  EXPECT_EQ(inputs["Anisotropic"], 0);
  EXPECT_EQ(inputs["Specular IOR Level"], 0.5);
  EXPECT_EQ(inputs.size(), 12U);
}

// OpenPBR's base looks rougher below a rough coat; Blender's has the roughness that it is given, so
// it is given that of the look, (r^4 + 2 r_coat^4)^(1/4).
TEST(FormatPrincipled, HasTheRoughnessThatIsSeenThroughTheCoat) {
  OpenPbr material;
  material.specular_roughness = 0.2;
  material.coat_weight = 1;
  material.coat_roughness = 0.5;
  const nlohmann::json inputs = nlohmann::json::parse(FormatPrincipled(material, kNotes))["inputs"];
  EXPECT_NEAR(inputs["Roughness"], std::pow(0.0016 + 2 * 0.0625, 0.25), 1e-4);
  EXPECT_NEAR(inputs["Coat Roughness"], 0.5, 1e-9);
}

// Both of Blender's alphas: r^2 / a and r^2 a, a = sqrt(1 - 0.9 anisotropic).
TEST(FormatPrincipled, HasTheSameTwoRoughnesses) {
  OpenPbr material;
  material.specular_roughness = 0.5;
  material.specular_roughness_anisotropy = 0.6;
  const nlohmann::json inputs = nlohmann::json::parse(FormatPrincipled(material, kNotes))["inputs"];
  const double r2 = std::pow(inputs["Roughness"].get<double>(), 2);
  const double a = std::sqrt(1 - 0.9 * inputs["Anisotropic"].get<double>());
  const double along = 0.25 * std::sqrt(2 / (1 + 0.16));
  EXPECT_NEAR(r2 / a, along, 1e-3);
  EXPECT_NEAR(r2 * a, 0.4 * along, 1e-3);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
