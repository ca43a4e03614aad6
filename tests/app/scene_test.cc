// `trilobe plan`, `fit --scene` and `compare` as a script or a person sees them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "io/formats/databases/merl_file.h"
#include "tests/app/run_on_terminal.h"
#include "tests/app/run_program.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/load_model.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::HasSubstr;

constexpr const char* kScene = R"({
  "format": "trilobe-scene", "version": 1,
  "directions": {"theta_i": [0, 30], "theta_o": [0, 30]},
  "budget": {"relative_rise": 0.05},
  "materials": [
    {"name": "wall", "source": "synth:rubber@30x30x60"},
    {"name": "curtain", "source": "synth:felt@30x30x60", "channels": "luminance"}
  ]
})";

std::string MakeScene(const TemporaryFolder& folder, const std::string& text = kScene) {
  std::ofstream(folder / "scene.json") << text;
  return folder / "scene.json";
}

// A command with a cache of the test's own and a quick solver.
ProgramResult RunQuickly(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--solver=awls", "--max_iterations=2", "--lobes=1",
                                     "--cache=" + (folder / "cache")});
  return RunProgram(arguments);
}

// A few scattered samples, whose path is returned.
std::string FewSamples(const TemporaryFolder& folder, const std::string& material) {
  const std::string path = folder / "few.csv";
  const ProgramResult made =
      RunProgram({"convert", "synth:" + material, "--missing=0.95", "--out=" + path});
  EXPECT_EQ(made.status, 0) << made.err;
  return path;
}

// The flags of a command, with their defaults, as its help has them.
std::map<std::string, std::string> HelpFlags(const std::string& command) {
  std::map<std::string, std::string> flags;
  std::istringstream help(RunProgram({"help", command, "--all"}).out);
  for (std::string line; std::getline(help, line);) {
    const size_t equal = line.find('=');
    if (!line.starts_with("  --") || equal == std::string::npos) continue;
    flags[line.substr(4, equal - 4)] = line.substr(equal + 1);
  }
  return flags;
}

// A value of the same type as the default.
std::string OtherValue(const std::string& value) {
  if (value == "true" || value == "false") return value == "true" ? "false" : "true";
  const bool number = !value.empty() && value.find_first_not_of("0123456789.e-") == value.npos;
  return value == "..." || !number ? "x" : value.starts_with("-") ? "3" : "1" + value;
}

nlohmann::json Json(const std::string& path) { return nlohmann::json::parse(Contents(path)); }

// A table, scattered samples, and those of an anisotropic material.
TEST(Scene, HasTheModelOfAFitWhereItLeavesNothingOut) {
  const TemporaryFolder folder;
  const std::string sources[] = {"synth:plastic@20x20x40", FewSamples(folder, "rubber@30x30x60"),
                                 "synth:velvet@4x8"};
  const std::string names[] = {"plastic", "few", "velvet"};
  const std::string scene = MakeScene(folder, R"({
    "format": "trilobe-scene", "version": 1,
    "leave_out": {"lobes": false, "colour": false, "shadowing": false, "tables": false,
                  "samples": false},
    "materials": [{"name": "plastic", "source": "synth:plastic@20x20x40"},
                  {"name": "few", "source": "few.csv"},
                  {"name": "velvet", "source": "synth:velvet@4x8"}]})");
  const auto fit = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "fit");
    arguments.insert(arguments.end(), {"--solver=awls", "--max_iterations=2", "--lobes=1"});
    const ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
  };
  fit({"--scene=" + scene, "--out=" + (folder / "scene"), "--nocache"});
  fit({sources[0], sources[1], sources[2], "--out=" + (folder / "many")});
  for (int k = 0; k < 3; ++k) {
    fit({sources[k], "--threads=1", "--out=" + (folder / "one")});
    const nlohmann::json one = Json(folder / "one/model.json");
    const nlohmann::json of_scene = Json(folder / "scene/" + names[k] + ".json");
    const nlohmann::json of_many = Json(folder / "many/" + names[k] + "/model.json");
    for (const char* const key : {"d", "s", "D", "F", "G", "unobserved"}) {
      EXPECT_EQ(of_scene[key], one[key]) << names[k] << " " << key;
      EXPECT_EQ(of_many[key], one[key]) << names[k] << " " << key;
    }
    EXPECT_EQ(of_scene["fit"]["objective"], one["fit"]["objective"]);
  }
}

TEST(Scene, AModelIsItsOwnFit) {
  const TemporaryFolder folder;
  const std::string scene = MakeScene(folder, R"({
    "format": "trilobe-scene", "version": 1,
    "directions": {"theta_i": [0, 10], "theta_o": [0, 10]},
    "leave_out": {"lobes": false, "colour": false, "shadowing": false, "tables": false},
    "materials": [{"name": "paper", "source": "material:paper_white"}]
  })");
  const ProgramResult fit =
      RunQuickly(folder, {"fit", "--scene=" + scene, "--out=" + (folder / "x")});
  ASSERT_EQ(fit.status, 0) << fit.err;
  const FactorModel model = ReadModel(folder / "x/paper.json").model;
  const FactorModel given = LoadModel("material:paper_white").model;
  EXPECT_TRUE(std::ranges::equal(model.d(), given.d()));
  EXPECT_EQ(model.spec(), given.spec());
  MakeScene(folder, R"({"format": "trilobe-scene", "version": 1,
                        "materials": [{"name": "x", "source": "material:paper_whit"}]})");
  EXPECT_THAT(RunProgram({"plan", scene}).err, HasSubstr("did you mean 'material:paper_white'?"));
}

// The budget counts the samples, not what a prior says between them.
TEST(Scene, KeepsToItsBudgetOnScatteredSamples) {
  const TemporaryFolder folder;
  const std::string source = FewSamples(folder, "plastic@30x30x60");
  const std::string scene = MakeScene(folder, R"({
    "format": "trilobe-scene", "version": 1, "budget": {"relative_rise": 0.01},
    "materials": [{"name": "few", "source": "few.csv"}]})");
  const ProgramResult fit =
      RunProgram({"fit", "--scene=" + scene, "--solver=awls", "--max_iterations=10", "--nocache",
                  "--out=" + (folder / "out")});
  ASSERT_EQ(fit.status, 0) << fit.err;
  const nlohmann::json material = Json(folder / "out/plan.json")["materials"][0];
  const double full = material["objective"]["full"];
  EXPECT_LT(material["parameters"]["pruned"], material["parameters"]["full"]);
  EXPECT_LE(material["objective"]["pruned"], 1.01 * full * (1 + 1e-12));
  const nlohmann::json score =
      nlohmann::json::parse(RunProgram({"score", folder / "out/few.json", source, "--json"}).out);
  EXPECT_LE(score["objective"], 1.01 * full * (1 + 1e-9));
  for (const nlohmann::json& decision : material["decisions"]) {
    if (!decision["taken"]) continue;
    EXPECT_LE(decision["objective_after"], 1.01 * full * (1 + 1e-12)) << decision["what"];
  }
}

// A table, an anisotropic material and scattered samples, each within angles of its own.
TEST(Scene, IsScoredAsItWasPlanned) {
  const TemporaryFolder folder;
  const std::string few = FewSamples(folder, "rubber@30x30x60");
  const std::string scene = MakeScene(folder, R"({
    "format": "trilobe-scene", "version": 1, "budget": {"relative_rise": 0.05},
    "materials": [
      {"name": "table", "source": "synth:plastic@20x20x40", "budget": {"mean_delta_e": 2},
       "directions": {"theta_i": [0, 60], "theta_o": [0, 60]}},
      {"name": "cloth", "source": "synth:velvet@4x8",
       "directions": {"theta_i": [0, 45], "theta_o": [0, 45]}},
      {"name": "few", "source": "few.csv",
       "directions": {"theta_i": [0, 50], "theta_o": [0, 50]}}]})");
  const ProgramResult fit =
      RunQuickly(folder, {"fit", "--scene=" + scene, "--out=" + (folder / "out")});
  ASSERT_EQ(fit.status, 0) << fit.err;
  const std::string sources[] = {"synth:plastic@20x20x40", "synth:velvet@4x8", few};
  const std::string angles[] = {"60", "45", "50"};
  for (int k = 0; k < 3; ++k) {
    const nlohmann::json planned = Json(folder / "out/plan.json")["materials"][k];
    const std::string model = folder / ("out/" + planned["name"].get<std::string>() + ".json");
    const nlohmann::json scored = nlohmann::json::parse(
        RunProgram({"score", model, sources[k], "--json", "--max_angle=" + angles[k]}).out);
    EXPECT_EQ(planned["samples"]["used"], scored["valid_samples"]) << model;
    EXPECT_EQ(planned["objective"]["pruned"], scored["objective"]) << model;
    EXPECT_EQ(planned["psnr_db"]["pruned"], scored["psnr_db"]) << model;
    const nlohmann::json& verdict = scored["verdict"];
    EXPECT_THAT(verdict["words"], HasSubstr(planned["verdict"].get<std::string>())) << model;
    EXPECT_EQ(planned["judged_by"], "sphere");
    EXPECT_EQ(planned["mean_delta_e"]["pruned"], verdict["mean_delta_e"]) << model;
    EXPECT_EQ(planned["seen_psnr_db"]["pruned"], verdict["psnr_db"]) << model;
  }
}

TEST(Scene, SaysThatItAddsAndWhy) {
  const TemporaryFolder folder;
  const std::string scene = MakeScene(folder, R"({
    "format": "trilobe-scene", "version": 1,
    "materials": [
      {"name": "better", "source": "synth:plastic@20x20x40", "budget": {"relative_rise": -0.2}},
      {"name": "roomy", "source": "synth:plastic@20x20x40", "budget": {"bytes": 1500}}]})");
  const ProgramResult plan = RunQuickly(folder, {"plan", scene});
  ASSERT_EQ(plan.status, 0) << plan.err;
  const std::string added = "\n  added:    2 lobes instead of one lobe: ";
  EXPECT_THAT(plan.out, HasSubstr(added));
  EXPECT_THAT(plan.out, HasSubstr("; with one lobe the budget is missed; E is "));
  EXPECT_THAT(plan.out, HasSubstr("; the budget has room for more parameters; E is "));
  EXPECT_THAT(plan.out, testing::Not(HasSubstr("left out: 2 lobes instead of one")));
}

// Both PSNRs are infinite.
TEST(Scene, AnExactFitLosesNothing) {
  const TemporaryFolder folder;
  BrdfTable black = MakeInvalidTable("black", {});
  for (auto& plane : black.stored) plane.assign(plane.size(), 0);
  WriteMerl(black, folder / "black.binary");
  const std::string scene = MakeScene(folder, R"({"format": "trilobe-scene", "version": 1,
                            "materials": [{"name": "soot", "source": "black.binary"}]})");
  const ProgramResult plan = RunQuickly(folder, {"plan", scene});
  ASSERT_EQ(plan.status, 0) << plan.err;
  EXPECT_THAT(plan.out, HasSubstr(" 0 %           0 dB "));
  EXPECT_THAT(plan.out, HasSubstr("\n  verdict:  cannot be told apart\n"));
  EXPECT_THAT(plan.out, testing::Not(HasSubstr("nan")));
  const ProgramResult compared = RunQuickly(folder, {"compare", scene});
  EXPECT_THAT(compared.out, HasSubstr("infinite  infinite\n"));
  EXPECT_THAT(compared.out, testing::Not(HasSubstr("nan")));
}

TEST(Scene, IsPlannedFittedAndCompared) {
  const TemporaryFolder folder;
  const std::string scene = MakeScene(folder), out = folder / "out";
  const ProgramResult plan = RunQuickly(folder, {"plan", scene});
  ASSERT_EQ(plan.status, 0) << plan.err;
  EXPECT_EQ(plan.err, "");
  EXPECT_THAT(plan.out, HasSubstr("\nwall: synth:rubber@30x30x60; E may rise by 5 %\n"));
  EXPECT_THAT(plan.out, HasSubstr("in directions that the scene does not use"));

  const ProgramResult fit = RunQuickly(folder, {"fit", "--scene=" + scene, "--out=" + out});
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("from the cache"));
  EXPECT_THAT(fit.out, HasSubstr(Contents(out + "/plan.txt")));
  const auto json = nlohmann::json::parse(Contents(out + "/plan.json"));
  EXPECT_EQ(json["reused"], 2);
  EXPECT_EQ(json["flags"]["solver"], "awls");
  ASSERT_EQ(json["materials"].size(), 2U);
  for (const auto& material : json["materials"]) {
    const std::string name = material["name"];
    const FactorModel model = ReadModel(out + "/" + name + ".json").model;
    EXPECT_EQ(model.spec().lobes, material["lobes"].get<int>());
    EXPECT_LT(material["parameters"]["pruned"].get<int>(),
              material["parameters"]["full"].get<int>());
    EXPECT_LT(material["samples"]["used"].get<int>(), material["samples"]["valid"].get<int>());
    EXPECT_LE(material["relative_rise"].get<double>(), 0.05 + 1e-12);
    const std::string verdict = material["verdict"];
    EXPECT_FALSE(verdict.empty());
    EXPECT_THAT(plan.out, HasSubstr(" %\n  verdict:  " + verdict + "\n"));
  }

  const ProgramResult of_scene = RunQuickly(folder, {"compare", scene, "--json"});
  ASSERT_EQ(of_scene.status, 0) << of_scene.err;
  const ProgramResult of_folder = RunProgram(
      {"compare", out, "--json", "--cache=" + (folder / "cache")});  // the other flags are kept
  ASSERT_EQ(of_folder.status, 0) << of_folder.err;
  EXPECT_EQ(of_folder.out, of_scene.out);
  const auto compared = nlohmann::json::parse(of_scene.out);
  ASSERT_EQ(compared["materials"].size(), 2U);
  for (size_t k = 0; k < 2; ++k) {
    const auto& row = compared["materials"][k];
    EXPECT_EQ(row["full"]["parameters"],
              ModelSpec::SharedFactors(1, {30, 30, 60}).num_parameters());
    EXPECT_EQ(row["pruned"]["parameters"], json["materials"][k]["parameters"]["pruned"]);
    const double planned = json["materials"][k]["objective"]["pruned"];
    EXPECT_NEAR(row["pruned"]["objective"].get<double>(), planned, 1e-10 * planned);
  }
  EXPECT_EQ(compared["all"]["seconds"]["pruned_reckoned"], true);

  for (const std::string& mine : {out + "/plan.json", out + "/wall.json", scene}) {
    const std::string before = Contents(mine);
    const ProgramResult refused = RunProgram({"compare", out, "--nocache", "--out=" + mine});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.err, HasSubstr("would destroy '"));
    EXPECT_EQ(Contents(mine), before);
  }
  const ProgramResult table = RunProgram(
      {"compare", out, "--cache=" + (folder / "cache"), "--out=" + (folder / "trade_off.png")});
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("\ncurtain "));
  EXPECT_THAT(table.out, HasSubstr("\nall "));
  EXPECT_TRUE(std::filesystem::exists(folder / "trade_off.png"));
}

TEST(Scene, AnInterruptKeepsWhatIsFinished) {
  const TemporaryFolder folder;
  const std::string scene = MakeScene(folder, R"({"format": "trilobe-scene", "version": 1,
      "materials": [
        {"name": "quick", "source": "synth:rubber@30x30x60", "budget": {"seconds": 1},
         "directions": {"theta_i": [0, 10], "theta_o": [0, 10]}},
        {"name": "slow", "source": "synth:felt@30x30x60"}]})");
  const std::string out = folder / "out";
  const TerminalResult result =
      RunOnTerminal({"fit", "--scene=" + scene, "--out=" + out, "--threads=1", "--solver=awls",
                     "--max_iterations=100000", "--tolerance=0", "--optimality_tolerance=0",
                     "--max_seconds=60", "--lobes=1", "--nocache"},
                    "1 of 2 materials finished", SIGINT);
  EXPECT_EQ(result.status, 128 + SIGINT) << result.text;
  EXPECT_TRUE(std::filesystem::exists(out + "/quick.json"));
  EXPECT_FALSE(std::filesystem::exists(out + "/slow.json"));
  EXPECT_THAT(result.text, HasSubstr("interrupted"));
  EXPECT_EQ(nlohmann::json::parse(Contents(out + "/plan.json"))["materials"].size(), 1U);
}

TEST(Scene, OneBadMaterialDoesNotStopTheOthers) {
  const TemporaryFolder folder;
  std::ofstream(folder / "torn.binary") << std::string("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12);
  const std::string scene = MakeScene(folder, R"({"format": "trilobe-scene", "version": 1,
      "directions": {"theta_i": [0, 10], "theta_o": [0, 10]},
      "materials": [{"name": "torn", "source": "torn.binary"},
                    {"name": "wall", "source": "synth:rubber@30x30x60"}]})");
  const std::string out = folder / "out";
  const ProgramResult fit = RunQuickly(folder, {"fit", "--scene=" + scene, "--out=" + out});
  EXPECT_EQ(fit.status, 3);
  EXPECT_THAT(fit.out, HasSubstr("\ntorn failed: "));
  EXPECT_THAT(fit.out, HasSubstr("torn.binary"));
  EXPECT_TRUE(std::filesystem::exists(out + "/wall.json"));
  const auto plan = nlohmann::json::parse(Contents(out + "/plan.json"));
  ASSERT_EQ(plan["materials"].size(), 1U);
  EXPECT_EQ(plan["materials"][0]["name"], "wall");
  ASSERT_EQ(plan["failed"].size(), 1U);
  EXPECT_EQ(plan["failed"][0]["name"], "torn");
  EXPECT_THAT(plan["failed"][0]["error"].get<std::string>(), HasSubstr("torn.binary"));
  const ProgramResult compare = RunQuickly(folder, {"compare", scene});
  EXPECT_EQ(compare.status, 1);
  EXPECT_THAT(compare.err, HasSubstr("material 'torn': "));
}

TEST(Scene, ItsFolderHoldsOneScene) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const auto fit = [&](const std::string& name) {
    const std::string scene = MakeScene(folder, R"({"format": "trilobe-scene", "version": 1,
        "directions": {"theta_i": [0, 10], "theta_o": [0, 10]},
        "materials": [{"name": ")" + name + R"(", "source": "synth:rubber@30x30x60"}]})");
    return RunQuickly(folder, {"fit", "--scene=" + scene, "--out=" + out});
  };
  ASSERT_EQ(fit("first").status, 0);
  std::ofstream(out + "/notes.json") << "{}";  // somebody's own
  ASSERT_EQ(fit("second").status, 0);
  EXPECT_FALSE(std::filesystem::exists(out + "/first.json"));
  EXPECT_TRUE(std::filesystem::exists(out + "/notes.json"));
  const auto plan = nlohmann::json::parse(Contents(out + "/plan.json"));
  EXPECT_EQ(plan["files"], nlohmann::json({"plan.json", "plan.txt", "second.json"}));
  EXPECT_EQ(ReadModel(out + "/second.json").fit.run, plan["run"]);

  // After a run that was killed, the plan says what there may be, and that it is no plan yet.
  std::ofstream(out + "/plan.json")
      << R"({"unfinished": true, "run": "0", "files": ["second.json"]})";
  const ProgramResult compare = RunQuickly(folder, {"compare", out});
  EXPECT_EQ(compare.status, 1);
  EXPECT_THAT(compare.err, HasSubstr("was cut off"));
  ASSERT_EQ(fit("third").status, 0);
  EXPECT_FALSE(std::filesystem::exists(out + "/second.json"));

  std::ofstream(out + "/plan.json") << R"({"plan": "of somebody"})";
  const ProgramResult refused = fit("fourth");
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("plan.json' exists, and Trilobe has not written it"));
}

TEST(Scene, DoesNotOverwriteItsOwnFiles) {
  const TemporaryFolder folder;
  const std::string scene = MakeScene(folder, R"({"format": "trilobe-scene", "version": 1,
      "materials": [{"name": "scene", "source": "synth:rubber@30x30x60"}]})");
  const std::string before = Contents(scene);
  const ProgramResult result =
      RunQuickly(folder, {"fit", "--scene=" + scene, "--out=" + (folder / "")});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("would destroy"));
  EXPECT_EQ(Contents(scene), before);
}

// A scene takes the flags of a measurement, and a file says others for single materials.
TEST(Scene, ReadsMeasurementsAsItIsTold) {
  const TemporaryFolder folder;
  std::ofstream(folder / "odd.csv") << [] {
    std::string text;
    for (int k = 0; k < 64; ++k) {
      const int i = 10 * (k % 8), o = 10 * (k / 8);
      const std::string f = std::to_string(25 * std::cos(o * kPi / 180));
      text += f + ",0," + std::to_string(i) + ",90," + std::to_string(o) + "\n";
    }
    return text;
  }();
  const std::string flags[] = {"--columns=f,phi_i,theta_i,phi_o,theta_o", "--cosine=o:1",
                               "--scale=0.01", "--weighting=log", "--prior=0.5"};
  const std::string options = R"(, "options": {"columns": "f,phi_i,theta_i,phi_o,theta_o",
      "cosine": "o:1", "scale": 0.01, "weighting": "log", "prior": 0.5})";
  const auto scene_with = [&](const std::string& name, const std::string& own) {
    const std::string path = folder / (name + ".json");
    std::ofstream(path) << R"({"format": "trilobe-scene", "version": 1,
      "materials": [{"name": "grey", "source": "odd.csv")" +
                               own + "}]}";
    return path;
  };
  const std::string plain = scene_with("plain", ""), told = scene_with("told", options);
  const auto fit = [&](const std::string& scene, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"fit", "--scene=" + scene, "--out=" + (folder / "out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunQuickly(folder, arguments);
  };
  const ProgramResult by_flags = fit(plain, {std::begin(flags), std::end(flags)});
  ASSERT_EQ(by_flags.status, 0) << by_flags.err;
  const FactorModel model = ReadModel(folder / "out/grey.json").model;
  EXPECT_NEAR(Evaluate(model, {{0, 0, 1}, {0, 0.6, 0.8}})[0], 0.25, 0.01);
  const ProgramResult by_file = fit(told, {"--scale=3"});  // the material's own goes first
  ASSERT_EQ(by_file.status, 0) << by_file.err;
  EXPECT_TRUE(std::ranges::equal(ReadModel(folder / "out/grey.json").model.parameters(),
                                 model.parameters()));
  EXPECT_THAT(RunProgram({"plan", scene_with("bad", R"(, "options": {"scale": "much"})")}).err,
              HasSubstr("/materials/0/options/scale: --scale=much"));
  EXPECT_THAT(RunProgram({"plan", scene_with("bad", R"(, "options": {"smoothness": 2})")}).err,
              HasSubstr("/materials/0/options/smoothness: --smoothness is 2; it must be"));
  EXPECT_THAT(RunProgram({"plan", scene_with("bad", R"(, "options": {"noize": 1})")}).err,
              HasSubstr("did you mean 'noise'"));
}

// A scene uses each flag of `fit`, or refuses it by name.
TEST(Scene, TakesEachFlagOrRefusesIt) {
  const TemporaryFolder folder;
  const std::string scene = MakeScene(folder);
  const std::map<std::string, std::string> taken = HelpFlags("plan"), all = HelpFlags("fit");
  EXPECT_GT(all.size(), 40);
  for (const auto& [flag, value] : all) {
    if (flag == "scene" || flag == "out" || flag == "force" || taken.contains(flag)) continue;
    const ProgramResult result = RunProgram({"fit", "--scene=" + scene, "--out=" + (folder / "o"),
                                             "--" + flag + "=" + OtherValue(value)});
    EXPECT_EQ(result.status, 1) << flag;
    EXPECT_THAT(result.err, HasSubstr("--" + flag)) << flag;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "o"));
}

TEST(Scene, BadUseIsAnError) {
  const TemporaryFolder folder;
  const std::string scene = MakeScene(folder), bad = folder / "bad.json";
  std::ofstream(bad) << R"({"format": "trilobe-scene", "version": 1, "materials": 3})";
  struct Case {
    std::vector<std::string> arguments;
    std::string error;
  };
  const std::vector<Case> cases = {
      {{"plan"}, "takes SCENE"},
      {{"plan", folder / "none.json"}, "none.json"},
      {{"plan", bad}, "bad.json: /materials: must be an array"},
      {{"plan", scene, "--out=x"}, "no flag --out"},
      {{"plan", scene, "--max_angle=100"}, "--max_angle is 100"},
      {{"compare", scene, "--max_angle=0", "--extrapolated"}, "--max_angle is 0"},
      {{"plan", scene, "--nocache", "--cache=x"}, "contradict"},
      {{"fit"}, "needs a SOURCE, or --scene"},
      {{"fit", "--scene=" + scene}, "needs --out=DIR"},
      {{"fit", "synth:felt@30x30x60", "--scene=" + scene}, "leave out synth:felt@30x30x60"},
      {{"fit", "synth:felt@30x30x60", "--nocache"}, "--nocache goes with --scene"},
      {{"fit", "--scene=" + scene, "--out=" + (folder / "o"), "--plots"}, "not for --scene"},
      {{"fit", "--scene=" + scene, "--out=" + (folder / "o"), "--convergence"}, "not for --scene"},
      {{"fit", "--scene=" + scene, "--out=" + (folder / "o"), "--raw"},
       "--raw is for the fit of one SOURCE, not for --scene"},
      {{"fit", "--scene=" + scene, "--out=" + (folder / "o"), "--max_parameters=100"},
       "--max_parameters is for the fit of one SOURCE, not for --scene"},
      {{"fit", "--scene=" + scene, "--out=" + (folder / "o"), "--model=auto"},
       "--model is for the fit of one SOURCE, not for --scene"},
      {{"fit", "--scene=" + scene, "--out=" + (folder / "o"), "--probe=x.hdr"},
       "--probe is for the fit of one SOURCE, not for --scene"},
      {{"fit", "--scene=" + bad, "--out=" + (folder / "o")}, "/materials"},
      {{"compare", folder / "none"}, "none"},
      {{"compare", folder / "."}, "plan.json"},
  };
  for (const Case& bad_case : cases) {
    const ProgramResult result = RunProgram(bad_case.arguments, {"XDG_CACHE_HOME=/nowhere"});
    EXPECT_EQ(result.status, 1) << bad_case.error;
    EXPECT_THAT(result.err, HasSubstr(bad_case.error));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "o"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
