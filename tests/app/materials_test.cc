#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/app/run_program.h"
#include "tests/paths.h"

namespace trilobe {
namespace {

using testing::HasSubstr;

nlohmann::json Listed() {
  return nlohmann::json::parse(Contents(InRepository("materials/materials.json")));
}

TEST(Materials, AreListedWithWhereTheyComeFrom) {
  const ProgramResult result = RunProgram({"materials"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json listed = Listed();
  EXPECT_EQ(std::ranges::count(result.out, '\n'), static_cast<int>(listed.size()));
  for (const nlohmann::json& material : listed) {
    EXPECT_THAT(result.out, HasSubstr("  " + material["name"].get<std::string>() + " "));
    EXPECT_EQ(material["licence"], "CC0 1.0");
    EXPECT_LE(material["parameters"],
              material["source"].get<std::string>().starts_with("RGL") ? 822 : 4062);
  }
}

TEST(Materials, StandWhereverAModelIsTaken) {
  const TemporaryFolder folder;
  const std::string material = "material:" + Listed()[0]["name"].get<std::string>();
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"info", material},
           {"view", material, "--out=" + (folder / "x.html")},
           {"convert", material, "--out=" + (folder / "x.glsl")},
           {"convert", material, "--out=" + (folder / "x.csv"), "--max_angle=10"},
           {"score", material, "synth:felt@30x30x60"},
           {"fit", "synth:felt@30x30x60", "--init=" + material, "--solver=awls",
            "--max_iterations=1"}}) {
    const ProgramResult result = RunProgram(command);
    EXPECT_EQ(result.status, 0) << command[0] << ": " << result.err;
  }
}

TEST(Materials, OfAnotherNameAreToldInOneLine) {
  for (const std::string name : {"none", "", "materials", "../x", "acrylic_felt_pnik"}) {
    const ProgramResult result = RunProgram({"info", "material:" + name});
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.err, HasSubstr("there is no material of this name; "));
    EXPECT_THAT(result.err, HasSubstr("`trilobe materials` lists all"));
    EXPECT_EQ(result.err.find("did you mean 'material:acrylic_felt_pink'?") != std::string::npos,
              name == "acrylic_felt_pnik");
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1);
  }
}

TEST(Materials, AreNoMeasurementsNorMeasurementsModels) {
  const TemporaryFolder folder;
  const std::string material = "material:" + Listed()[0]["name"].get<std::string>();
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"fit", material, "--out=" + (folder / "fit")},
           {"plot", material, material, "--out=" + (folder / "plot")},
           {"view", material, material, "--out=" + (folder / "x.html")}}) {
    const ProgramResult result = RunProgram(command);
    EXPECT_EQ(result.status, 1) << command[0];
    EXPECT_THAT(result.err, HasSubstr(material + ": this is a model; give the file of a"));
  }
  const ProgramResult result = RunProgram({"view", "synth:felt", "--out=" + (folder / "x.html")});
  EXPECT_THAT(result.err, HasSubstr("synth:felt: this is a measurement; a model is"));
  EXPECT_FALSE(std::filesystem::exists(folder / "x.html"));
}

}  // namespace
}  // namespace trilobe
