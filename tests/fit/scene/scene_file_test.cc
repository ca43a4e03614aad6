#include "fit/scene/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "core/files/json_value.h"
#include "tests/test_directory.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kBegin = R"({"format": "trilobe-scene", "version": 1)";

// A scene of one material with these members more, of the scene and of the material.
std::string Text(const std::string& of_scene, const std::string& of_material = "") {
  return kBegin + of_scene + R"(, "materials": [{"name": "a", "source": "synth:felt")" +
         of_material + "}]}";
}

SceneMaterial Material(const std::string& text) {
  return ParseScene(text, "s.json").materials.at(0);
}

TEST(SceneFile, DefaultsToAllOfEverythingAndOnePercent) {
  const SceneMaterial material = Material(Text(""));
  EXPECT_EQ(material.name, "a");
  EXPECT_EQ(material.source, "synth:felt");
  EXPECT_TRUE(std::holds_alternative<AllDirections>(material.directions));
  EXPECT_EQ(material.channels, SceneChannels::kRgb);
  EXPECT_EQ(material.budget.unit, SceneBudget::Unit::kRelativeRise);
  EXPECT_EQ(material.budget.amount, 0.01);
  const SceneReductions& reductions = material.reductions;
  EXPECT_TRUE(reductions.lobes && reductions.colour && reductions.shadowing && reductions.tables &&
              reductions.samples);
}

TEST(SceneFile, MaterialsTakeTheScenesLimitsUnlessTheyHaveTheirOwn) {
  const std::string scene = R"(, "channels": "luminance", "budget": {"bytes": 1000},
      "leave_out": {"lobes": false, "tables": false})";
  const SceneMaterial plain = Material(Text(scene));
  EXPECT_EQ(plain.channels, SceneChannels::kLuminance);
  EXPECT_EQ(plain.budget.unit, SceneBudget::Unit::kBytes);
  EXPECT_EQ(plain.budget.amount, 1000);
  EXPECT_FALSE(plain.reductions.lobes);
  EXPECT_FALSE(plain.reductions.tables);
  const SceneMaterial own = Material(Text(scene, R"(, "channels": "rgb",
      "budget": {"seconds": 2.5}, "leave_out": {"lobes": true, "samples": false})"));
  EXPECT_EQ(own.channels, SceneChannels::kRgb);
  EXPECT_EQ(own.budget.unit, SceneBudget::Unit::kSeconds);
  EXPECT_EQ(own.budget.amount, 2.5);
  const auto budget_of = [&](const std::string& json) {
    return ParseScene(Text(R"(, "budget": )" + json), "scene.json").materials[0].budget;
  };
  EXPECT_EQ(budget_of(R"({"mean_delta_e": 1.5})").unit, SceneBudget::Unit::kMeanDeltaE);
  EXPECT_EQ(budget_of(R"({"sphere_psnr_db": 40})").unit, SceneBudget::Unit::kSpherePsnr);
  EXPECT_EQ(budget_of(R"({"sphere_psnr_db": 40})").amount, 40);
  const SceneMaterial told = Material(Text(R"(, "options": {"scale": 0.5, "outliers": true})",
                                           R"(, "options": {"scale": 2, "cosine": "o:1"})"));
  const SourceOptions options =
      WithOptionsOf(told, SourceOptions{.noise = 0.1, .max_angle_deg = 80});
  EXPECT_EQ(options.scale, 2);
  EXPECT_EQ(options.cosine_o, 1);
  EXPECT_TRUE(options.outliers);
  EXPECT_EQ(options.noise, 0.1);
  EXPECT_EQ(options.max_angle_deg, 80);

  const SceneMaterial fitted = Material(Text(R"(, "options": {"lobes": 1, "robust": 0.1})",
                                             R"(, "options": {"lobes": 2, "weighting": "log"})"));
  const FitOptions fit = WithOptionsOf(fitted, FitOptions{.smoothness = 0.02});
  EXPECT_EQ(fit.form.lobes, 2);
  EXPECT_EQ(fit.weighting.name, "log");
  EXPECT_EQ(fit.robust, 0.1);
  EXPECT_EQ(fit.smoothness, 0.02);
  EXPECT_TRUE(own.reductions.lobes);    // its own
  EXPECT_FALSE(own.reductions.tables);  // the scene's
  EXPECT_FALSE(own.reductions.samples);
}

TEST(SceneFile, ReadsDirections) {
  const auto parsed = [](const std::string& json) {
    return Material(Text(R"(, "directions": )" + json)).directions;
  };
  EXPECT_TRUE(std::holds_alternative<AllDirections>(parsed("\"all\"")));
  const auto ranges = std::get<DirectionRanges>(parsed(R"({"theta_o": [30, 60]})"));
  EXPECT_EQ(ranges.theta_i.min, 0);
  EXPECT_DOUBLE_EQ(ranges.theta_i.max, kPi / 2);
  EXPECT_DOUBLE_EQ(ranges.theta_o.min, kPi / 6);
  EXPECT_DOUBLE_EQ(ranges.theta_o.max, kPi / 3);
  // In the plane of incidence, on the side of the mirror direction: theta_h is half the difference
  // of the angles, theta_d half their sum.
  const auto list =
      std::get<DirectionList>(parsed(R"({"list": [{"theta_i": 20, "theta_o": 50, "phi": 180}]})"));
  ASSERT_EQ(list.directions.size(), 1U);
  EXPECT_NEAR(list.directions[0].theta_h, DegreesToRadians(15), 1e-12);
  EXPECT_NEAR(list.directions[0].theta_d, DegreesToRadians(35), 1e-12);
}

TEST(SceneFile, FindsFilesBesideItself) {
  const TestDirectory directory;
  directory.Make("a.binary", "");
  std::string histogram(3 * 4 + 8, '\0');
  histogram[0] = histogram[4] = histogram[8] = 1;
  histogram[19] = 0x40;  // 2.0
  directory.Make("a.hist", histogram);
  const std::string path =
      directory.Make("scene.json", std::string(kBegin) + R"(, "directions": {"histogram": "a.hist"},
          "materials": [{"name": "a", "source": "a.binary"}]})");
  const Scene scene = ReadScene(path);
  EXPECT_EQ(scene.path, path);
  EXPECT_EQ(scene.materials[0].source, directory.Path("a.binary"));
  const auto& read = std::get<DirectionHistogram>(scene.materials[0].directions);
  EXPECT_EQ(read.counts, std::vector<double>{2.0});
}

TEST(SceneFile, BadOnesGetAnErrorWithKeyAndReason) {
  struct Bad {
    std::string text;
    std::string pointer;  // with the colon that ends it
    std::string reason;
  };
  const std::string materials = R"(, "materials": [{"name": "a", "source": "synth:felt"}])";
  const auto directions = [](const std::string& json) {
    return Text(R"(, "directions": )" + json);
  };
  const auto budget = [](const std::string& json) { return Text(R"(, "budget": )" + json); };
  const auto material = [](const std::string& json) {
    return kBegin + (R"(, "materials": [)" + json + "]}");
  };
  const std::vector<Bad> cases = {
      {"", "", "not a scene file: line 1, column 1:"},
      {"{\"format\": 1,}", "", "not a scene file: line 1, column 14:"},
      {std::string("{}\0", 3), "", "not a scene file: line 1, column 3:"},
      {"[]", "/:", "must be an object, not array"},
      {"{}", "/:", "the key 'format' is missing"},
      {R"({"format": "trilobe-model"})",
       "/format:", "must be 'trilobe-scene', not 'trilobe-model'"},
      {R"({"format": 3})", "/format:", "must be a string, not number"},
      {R"({"format": "trilobe-scene"})", "/:", "the key 'version' is missing"},
      {R"({"format": "trilobe-scene", "version": 2)" + materials + "}", "/version:", "not 2"},
      {R"({"format": "trilobe-scene", "version": "1"})", "/version:", "must be a number"},
      {std::string(kBegin) + "}", "/:", "the key 'materials' is missing"},
      {std::string(kBegin) + R"(, "materials": {}})", "/materials:", "must be an array"},
      {std::string(kBegin) + R"(, "materials": []})", "/materials:", "is empty"},
      {std::string(kBegin) + R"(, "material": []})",
       "/material:", "unknown key; did you mean 'materials'?"},
      {Text(R"(, "channels": "rgb", "channels": "rgb")"), "", "the key 'channels' comes twice"},
      {material("3"), "/materials/0:", "must be an object, not number"},
      {material("{}"), "/materials/0:", "the key 'name' is missing"},
      {material(R"({"name": "a"})"), "/materials/0:", "the key 'source' is missing"},
      {material(R"({"name": "a", "sorce": "x"})"), "/materials/0/sorce:", "did you mean 'source'?"},
      {material(R"({"name": "", "source": "synth:felt"})"),
       "/materials/0/name:", "is the name of a file"},
      {material(R"({"name": "a/b", "source": "synth:felt"})"), "/materials/0/name:", "no '/'"},
      {material(R"({"name": "..", "source": "synth:felt"})"), "/materials/0/name:", "no '.'"},
      {material(R"({"name": "a\nb", "source": "synth:felt"})"),
       "/materials/0/name:", "no control character"},
      {material(R"({"name": ")" + std::string(101, 'a') + R"(", "source": "synth:felt"})"),
       "/materials/0/name:", "1 to 100 bytes"},
      {material(R"({"name": "a", "source": "synth:felt"}, {"name": "a", "source": "synth:felt"})"),
       "/materials/1/name:", "'a' is the name of another material"},
      {material(R"({"name": "a", "source": "synth:felt"}, {"name": "A", "source": "synth:felt"})"),
       "/materials/1/name:",
       "'A' and 'a', another material, are one file where case does not count; give each its own"},
      {material(R"({"name": "Plan", "source": "synth:felt"})"),
       "/materials/0/name:", "is kept for plan.json; give the material another name"},
      {material(R"({"name": "a", "source": "nowhere.binary"})"),
       "/materials/0/source:", "there is no file 'nowhere.binary'"},
      {material(R"({"name": "a", "source": "."})"), "/materials/0/source:", "there is no file"},
      {material(R"({"name": "a", "source": "synth:nothing"})"),
       "/materials/0/source:", "unknown synthetic material 'nothing'"},
      {material(R"({"name": "a", "source": ["synth:felt"]})"),
       "/materials/0/source:", "must be a string, not array"},
      {directions("3"), "/directions:", "must be an object, not number"},
      {directions("\"some\""), "/directions:", "must be 'all', not 'some'"},
      {directions("{}"), "/directions:", "must have one of"},
      {directions(R"({"theta_i": [0, 60], "list": []})"), "/directions:", "must have one of"},
      {directions(R"({"theta": [0, 60]})"), "/directions/theta:", "did you mean 'theta_i'?"},
      {directions(R"({"theta_i": 60})"), "/directions/theta_i:", "must be an array of two angles"},
      {directions(R"({"theta_i": [60]})"), "/directions/theta_i:", "must have two angles"},
      {directions(R"({"theta_i": [0, 91]})"), "/directions/theta_i/1:", "from 0 to 90, not 91"},
      {directions(R"({"theta_i": [-1, 60]})"), "/directions/theta_i/0:", "not -1"},
      {directions(R"({"theta_i": ["0", 60]})"), "/directions/theta_i/0:", "must be a number"},
      {directions(R"({"theta_o": [60, 0]})"), "/directions/theta_o:", "exchange the two"},
      {directions(R"({"list": {}})"), "/directions/list:", "must be an array of directions"},
      {directions(R"({"list": []})"), "/directions/list:", "is empty"},
      {directions(R"({"list": [{"theta_i": 1, "theta_o": 2}]})"),
       "/directions/list/0:", "the key 'phi' is missing"},
      {directions(R"({"list": [{"theta_i": 1, "theta_o": 90, "phi": 0}]})"),
       "/directions/list/0/theta_o:", "from 0 to 89.99, not 90"},
      {directions(R"({"list": [{"theta_i": 1, "theta_o": 2, "phi": 361}]})"),
       "/directions/list/0/phi:", "not 361"},
      {directions(R"({"histogram": "none.hist"})"),
       "/directions/histogram:", "cannot read 'none.hist'"},
      {directions(R"({"histogram": 3})"), "/directions/histogram:", "must be a string"},
      {Text(R"(, "channels": "rbg")"), "/channels:", "must be 'rgb' or 'luminance', not 'rbg'"},
      {Text("", R"(, "channels": 3)"), "/materials/0/channels:", "must be a string"},
      {budget("0.01"), "/budget:", "must be an object, not number"},
      {budget("{}"), "/budget:", "exactly one of"},
      {budget(R"({"bytes": 100, "seconds": 3})"), "/budget:", "exactly one of"},
      {budget(R"({"relativ_rise": 0.01})"),
       "/budget/relativ_rise:", "did you mean 'relative_rise'?"},
      {budget(R"({"relative_rise": -1.01})"), "/budget/relative_rise:", "from -1 to"},
      {budget(R"({"relative_rise": "1 %"})"), "/budget/relative_rise:", "must be a number"},
      {budget(R"({"psnr_drop_db": 1001})"), "/budget/psnr_drop_db:", "must be decibels"},
      {budget(R"({"mean_delta_e": -1})"), "/budget/mean_delta_e:", "from 0 to 100"},
      {budget(R"({"sphere_psnr_db": "high"})"), "/budget/sphere_psnr_db:", "must be a number"},
      {budget(R"({"bytes": 7})"), "/budget/bytes:", "from 8 up, not 7"},
      {budget(R"({"seconds": 1e999})"), "", "not a scene file"},
      {Text("", R"(, "budget": {"seconds": null})"),
       "/materials/0/budget/seconds:", "must be a number, seconds, not null"},
      {Text(R"(, "leave_out": ["lobes"])"), "/leave_out:", "must be an object"},
      {Text(R"(, "leave_out": {"color": true})"), "/leave_out/color:", "did you mean 'colour'?"},
      {Text(R"(, "leave_out": {"lobes": 1})"), "/leave_out/lobes:", "must be true or false"},
      {Text("", R"(, "leave~/out": 1)"), "/materials/0/leave~0~1out:", "unknown key"},
  };
  for (const Bad& bad : cases) {
    const std::string error = ErrorOf([&] { ParseScene(bad.text, "s.json"); });
    EXPECT_THAT(error, AllOf(StartsWith("s.json: " + bad.pointer), HasSubstr(bad.reason)))
        << bad.text;
  }
}

TEST(SceneFile, AFileThatIsTooLargeIsAnError) {
  const TestDirectory directory;
  const std::string path = directory.Make("scene.json", Text(""));
  std::filesystem::resize_file(path, kMaxJsonBytes + 1);
  EXPECT_THAT(ErrorOf([&] { ReadScene(path); }),
              HasSubstr("scene.json: not a scene file: it has 16777217 bytes"));
}

// Cut anywhere, a scene is no scene, and no crash.
TEST(SceneFile, CutOffOnesAreErrors) {
  const std::string text = Text(R"(, "directions": {"theta_i": [0, 60]})");
  for (size_t size = 0; size < text.size(); ++size) {
    EXPECT_THAT(ErrorOf([&] { ParseScene(text.substr(0, size), "s.json"); }),
                StartsWith("s.json: not a scene file"));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
