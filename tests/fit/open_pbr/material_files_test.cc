#include "fit/open_pbr/material_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "trilobe/core/math/angles.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

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
  // As many elements are opened as closed.
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

// Where OpenPBR's base is rougher below a rough coat, Blender's is as rough as it says.
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
