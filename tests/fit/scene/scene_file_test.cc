#include "fit/scene/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "core/files/json_value.h"
#include "tests/error_of.h"
#include "tests/test_directory.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

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
    ErrorKind kind;
    ErrorFacts facts;
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
      {"", ErrorKind::kFormat, {.line = 1, .key = "column", .value = "1"}},
      {"{\"format\": 1,}", ErrorKind::kFormat, {.line = 1, .key = "column", .value = "14"}},
      {std::string("{}\0", 3), ErrorKind::kFormat, {.line = 1, .key = "column", .value = "3"}},
      {"[]", ErrorKind::kFormat, {.key = "/", .value = "array"}},
      {"{}", ErrorKind::kMissing, {.key = "/", .value = "format"}},
      {R"({"format": "trilobe-model"})",
       ErrorKind::kUnknown,
       {.key = "/format", .value = "trilobe-model"}},
      {R"({"format": 3})", ErrorKind::kFormat, {.key = "/format", .value = "number"}},
      {R"({"format": "trilobe-scene"})", ErrorKind::kMissing, {.key = "/", .value = "version"}},
      {R"({"format": "trilobe-scene", "version": 2)" + materials + "}",
       ErrorKind::kRange,
       {.key = "/version", .value = "2"}},
      {R"({"format": "trilobe-scene", "version": "1"})",
       ErrorKind::kFormat,
       {.key = "/version", .value = "string"}},
      {std::string(kBegin) + "}", ErrorKind::kMissing, {.key = "/", .value = "materials"}},
      {std::string(kBegin) + R"(, "materials": {}})",
       ErrorKind::kFormat,
       {.key = "/materials", .value = "object"}},
      {std::string(kBegin) + R"(, "materials": []})", ErrorKind::kMissing, {.key = "/materials"}},
      {std::string(kBegin) + R"(, "material": []})",
       ErrorKind::kUnknown,
       {.key = "/material", .value = "material"}},
      {Text(R"(, "channels": "rgb", "channels": "rgb")"),
       ErrorKind::kConflict,
       {.line = 1, .key = "column", .value = "134"}},
      {material("3"), ErrorKind::kFormat, {.key = "/materials/0", .value = "number"}},
      {material("{}"), ErrorKind::kMissing, {.key = "/materials/0", .value = "name"}},
      {material(R"({"name": "a"})"),
       ErrorKind::kMissing,
       {.key = "/materials/0", .value = "source"}},
      {material(R"({"name": "a", "sorce": "x"})"),
       ErrorKind::kUnknown,
       {.key = "/materials/0/sorce", .value = "sorce"}},
      {material(R"({"name": "", "source": "synth:felt"})"),
       ErrorKind::kFormat,
       {.key = "/materials/0/name"}},
      {material(R"({"name": "a/b", "source": "synth:felt"})"),
       ErrorKind::kFormat,
       {.key = "/materials/0/name", .value = "a/b"}},
      {material(R"({"name": "..", "source": "synth:felt"})"),
       ErrorKind::kFormat,
       {.key = "/materials/0/name", .value = ".."}},
      {material(R"({"name": "a\nb", "source": "synth:felt"})"),
       ErrorKind::kFormat,
       {.key = "/materials/0/name", .value = "a\nb"}},
      {material(R"({"name": ")" + std::string(101, 'a') + R"(", "source": "synth:felt"})"),
       ErrorKind::kFormat,
       {.key = "/materials/0/name"}},
      {material(R"({"name": "a", "source": "synth:felt"}, {"name": "a", "source": "synth:felt"})"),
       ErrorKind::kRange,
       {.key = "/materials/1/name"}},
      {material(R"({"name": "a", "source": "synth:felt"}, {"name": "A", "source": "synth:felt"})"),
       ErrorKind::kRange,
       {.key = "/materials/1/name"}},
      {material(R"({"name": "Plan", "source": "synth:felt"})"),
       ErrorKind::kConflict,
       {.key = "/materials/0/name", .value = "Plan"}},
      {material(R"({"name": "a", "source": "nowhere.binary"})"),
       ErrorKind::kFile,
       {.key = "/materials/0/source", .value = "nowhere.binary"}},
      {material(R"({"name": "a", "source": "."})"),
       ErrorKind::kFile,
       {.key = "/materials/0/source", .value = "."}},
      {material(R"({"name": "a", "source": "synth:nothing"})"),
       ErrorKind::kUnknown,
       {.key = "/materials/0/source", .value = "nothing"}},
      {material(R"({"name": "a", "source": ["synth:felt"]})"),
       ErrorKind::kFormat,
       {.key = "/materials/0/source", .value = "array"}},
      {directions("3"), ErrorKind::kFormat, {.key = "/directions", .value = "number"}},
      {directions("\"some\""), ErrorKind::kUnknown, {.key = "/directions", .value = "some"}},
      {directions("{}"), ErrorKind::kRange, {.key = "/directions"}},
      {directions(R"({"theta_i": [0, 60], "list": []})"),
       ErrorKind::kRange,
       {.key = "/directions"}},
      {directions(R"({"theta": [0, 60]})"),
       ErrorKind::kUnknown,
       {.key = "/directions/theta", .value = "theta"}},
      {directions(R"({"theta_i": 60})"),
       ErrorKind::kFormat,
       {.key = "/directions/theta_i", .value = "number"}},
      {directions(R"({"theta_i": [60]})"), ErrorKind::kRange, {.key = "/directions/theta_i"}},
      {directions(R"({"theta_i": [0, 91]})"),
       ErrorKind::kRange,
       {.key = "/directions/theta_i/1", .value = "91"}},
      {directions(R"({"theta_i": [-1, 60]})"),
       ErrorKind::kRange,
       {.key = "/directions/theta_i/0", .value = "-1"}},
      {directions(R"({"theta_i": ["0", 60]})"),
       ErrorKind::kFormat,
       {.key = "/directions/theta_i/0", .value = "string"}},
      {directions(R"({"theta_o": [60, 0]})"), ErrorKind::kRange, {.key = "/directions/theta_o"}},
      {directions(R"({"list": {}})"),
       ErrorKind::kFormat,
       {.key = "/directions/list", .value = "object"}},
      {directions(R"({"list": []})"), ErrorKind::kMissing, {.key = "/directions/list"}},
      {directions(R"({"list": [{"theta_i": 1, "theta_o": 2}]})"),
       ErrorKind::kMissing,
       {.key = "/directions/list/0", .value = "phi"}},
      {directions(R"({"list": [{"theta_i": 1, "theta_o": 90, "phi": 0}]})"),
       ErrorKind::kRange,
       {.key = "/directions/list/0/theta_o", .value = "90"}},
      {directions(R"({"list": [{"theta_i": 1, "theta_o": 2, "phi": 361}]})"),
       ErrorKind::kRange,
       {.key = "/directions/list/0/phi", .value = "361"}},
      {directions(R"({"histogram": "none.hist"})"),
       ErrorKind::kFile,
       {.key = "/directions/histogram", .value = "No such file or directory"}},
      {directions(R"({"histogram": 3})"),
       ErrorKind::kFormat,
       {.key = "/directions/histogram", .value = "number"}},
      {Text(R"(, "channels": "rbg")"), ErrorKind::kUnknown, {.key = "/channels", .value = "rbg"}},
      {Text("", R"(, "channels": 3)"),
       ErrorKind::kFormat,
       {.key = "/materials/0/channels", .value = "number"}},
      {budget("0.01"), ErrorKind::kFormat, {.key = "/budget", .value = "number"}},
      {budget("{}"), ErrorKind::kRange, {.key = "/budget"}},
      {budget(R"({"bytes": 100, "seconds": 3})"), ErrorKind::kRange, {.key = "/budget"}},
      {budget(R"({"relativ_rise": 0.01})"),
       ErrorKind::kUnknown,
       {.key = "/budget/relativ_rise", .value = "relativ_rise"}},
      {budget(R"({"relative_rise": -1.01})"),
       ErrorKind::kRange,
       {.key = "/budget/relative_rise", .value = "-1.01"}},
      {budget(R"({"relative_rise": "1 %"})"),
       ErrorKind::kFormat,
       {.key = "/budget/relative_rise", .value = "string"}},
      {budget(R"({"psnr_drop_db": 1001})"),
       ErrorKind::kRange,
       {.key = "/budget/psnr_drop_db", .value = "1001"}},
      {budget(R"({"mean_delta_e": -1})"),
       ErrorKind::kRange,
       {.key = "/budget/mean_delta_e", .value = "-1"}},
      {budget(R"({"sphere_psnr_db": "high"})"),
       ErrorKind::kFormat,
       {.key = "/budget/sphere_psnr_db", .value = "string"}},
      {budget(R"({"bytes": 7})"), ErrorKind::kRange, {.key = "/budget/bytes", .value = "7"}},
      {budget(R"({"seconds": 1e999})"),
       ErrorKind::kRange,
       {.line = 1, .key = "column", .value = "65"}},
      {Text("", R"(, "budget": {"seconds": null})"),
       ErrorKind::kFormat,
       {.key = "/materials/0/budget/seconds", .value = "null"}},
      {Text(R"(, "leave_out": ["lobes"])"),
       ErrorKind::kFormat,
       {.key = "/leave_out", .value = "array"}},
      {Text(R"(, "leave_out": {"color": true})"),
       ErrorKind::kUnknown,
       {.key = "/leave_out/color", .value = "color"}},
      {Text(R"(, "leave_out": {"lobes": 1})"),
       ErrorKind::kFormat,
       {.key = "/leave_out/lobes", .value = "number"}},
      {Text("", R"(, "leave~/out": 1)"),
       ErrorKind::kUnknown,
       {.key = "/materials/0/leave~0~1out", .value = "leave~/out"}},
  };
  for (const Bad& bad : cases) {
    ErrorFacts facts = bad.facts;
    facts.file = "s.json";
    EXPECT_THAT(ErrorOf([&] { ParseScene(bad.text, "s.json"); }), IsError(bad.kind, facts))
        << bad.text;
  }
}

TEST(SceneFile, AFileThatIsTooLargeIsAnError) {
  const TestDirectory directory;
  const std::string path = directory.Make("scene.json", Text(""));
  std::filesystem::resize_file(path, kMaxJsonBytes + 1);
  EXPECT_THAT(ErrorOf([&] { ReadScene(path); }),
              IsError(ErrorKind::kLimit, {.file = path, .key = "bytes", .value = "16777217"}));
}

// Cut anywhere, a scene is no scene, and no crash.
TEST(SceneFile, CutOffOnesAreErrors) {
  const std::string text = Text(R"(, "directions": {"theta_i": [0, 60]})");
  for (size_t size = 0; size < text.size(); ++size) {
    EXPECT_THAT(ErrorOf([&] { ParseScene(text.substr(0, size), "s.json"); }),
                IsError(ErrorKind::kFormat, {.file = "s.json", .line = 1, .key = "column"}));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
