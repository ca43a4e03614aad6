// All commands, given an anisotropic model or measurement.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "tests/app/run_program.h"
#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/read_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kVelvet = "synth:velvet@4x12";
constexpr const char* kSilk = "synth:shot_silk@4x12";  // of which there is nothing to note

class AnisotropicCommands : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    fit_ = RunProgram({"fit", kVelvet, "--lobes=1", "--d_nodes=4x12", "--g_nodes=4x12",
                       "--solver=awls", "--max_iterations=5", "--verbose",
                       kSanitized ? "--noplots" : "--plots", "--reconstruction",
                       "--out=" + In("fit")});
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string In(const std::string& name) { return *folder_ / name; }
  static json Parse(const std::string& text) { return json::parse(text); }

  static void ExpectRefusal(const std::vector<std::string>& arguments, const std::string& part) {
    const ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.status, 1) << part;
    EXPECT_THAT(result.err, StartsWith("trilobe: error: "));
    EXPECT_THAT(result.err, HasSubstr(part));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  }

  static TemporaryFolder* folder_;
  static ProgramResult fit_;
};
TemporaryFolder* AnisotropicCommands::folder_ = nullptr;
ProgramResult AnisotropicCommands::fit_;

TEST_F(AnisotropicCommands, FitReportsAppearanceAndDrawsAll) {
  ASSERT_EQ(fit_.status, 0) << fit_.err;
  EXPECT_THAT(fit_.out, HasSubstr("appearance   sphere in studio: PSNR"));
  EXPECT_THAT(fit_.out, HasSubstr(" at nodes, "));
  EXPECT_THAT(fit_.out, testing::Not(HasSubstr("an isotropic model leaves out")));
  for (const char* name : {"factors.png", "slices.png", "spheres.png", "cloth.png"}) {
    if (kSanitized) continue;  // tests of the pictures draw them, too
    EXPECT_THAT(Contents(In("fit/") + name), StartsWith("\x89PNG\r\n")) << name;
  }
  const json report = Parse(Contents(In("fit/report.json")));
  EXPECT_GT(report["appearance"]["psnr_db"], 10);
  EXPECT_EQ(report["appearance"]["albedo"]["values"].size(), 12U);
  EXPECT_EQ(report["appearance"]["albedo"]["values"][6]["phi_i_deg"], 90);
  EXPECT_TRUE(report["anisotropy_left_out"].is_null());

  const ProgramResult score =
      RunProgram({"score", In("fit/model.json"), kVelvet, "--json", "--out=" + In("pair.png")});
  ASSERT_EQ(score.status, 0) << score.err;
  EXPECT_EQ(Parse(score.out)["appearance"], report["appearance"]);
  EXPECT_TRUE(Parse(score.out)["worst_bins"][0].contains("phi_o_deg"));
  EXPECT_THAT(Contents(In("pair.png")), StartsWith("\x89PNG\r\n"));
}

// UTIA layout at its own directions; a fit of that is the same model, where nothing else is.
TEST_F(AnisotropicCommands, ReconstructionIsAMeasurementOfTheModel) {
  const std::string model = In("fit/model.json");
  ASSERT_EQ(RunProgram({"convert", model, "--out=" + In("c.bin")}).status, 0);
  EXPECT_EQ(Contents(In("c.bin")), Contents(In("fit/reconstruction.bin")));
  ASSERT_EQ(RunProgram({"convert", model, "--out=" + In("c.csv")}).status, 0);
  for (const char* const file : {"c.bin", "c.csv"}) {
    const ProgramResult score = RunProgram({"score", model, In(file), "--json"});
    ASSERT_EQ(score.status, 0) << score.err;
    EXPECT_LT(Parse(score.out)["relative_objective"], 1e-20) << file;
    EXPECT_LT(Parse(score.out)["appearance"]["at_centers"]["mean_log_error"], 1e-9) << file;
  }
  ExpectRefusal({"convert", model, "--out=" + In("c.binary")}, "end the name in .bin");
}

TEST_F(AnisotropicCommands, PageSaysWhatIsNotOnIt) {
  const std::string model = In("fit/model.json"), page = In("x.html");
  const ProgramResult both = RunProgram({"view", model, kVelvet, "--out=" + page});
  ASSERT_EQ(both.status, 0) << both.err;
  EXPECT_THAT(both.out, testing::Not(HasSubstr("note:")));
  const ProgramResult alone = RunProgram({"view", model, "synth:felt@12x12x24", "--out=" + page});
  ASSERT_EQ(alone.status, 0) << alone.err;
  EXPECT_THAT(alone.out, HasSubstr(": a page of the model alone of "));
  EXPECT_THAT(alone.out, HasSubstr("synth:felt@12x12x24 is not on it: a table knows no azimuths"));
}

TEST_F(AnisotropicCommands, IsotropicFitSaysWhatItLeavesOut) {
  const ProgramResult fit =
      RunProgram({"fit", kVelvet, "--model=isotropic", "--lobes=1", "--solver=awls",
                  "--max_iterations=3", "--verbose", "--noplots", "--out=" + In("isotropic")});
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("azimuths     an isotropic model leaves out "));
  const json report = Parse(Contents(In("isotropic/report.json")));
  const json info = Parse(RunProgram({"info", kVelvet, "--json"}).out);
  EXPECT_GT(report["anisotropy_left_out"], 0.01);
  EXPECT_EQ(report["anisotropy_left_out"], info["anisotropy"]["share"]);
  const json anisotropic = Parse(Contents(In("fit/report.json")));
  EXPECT_GT(anisotropic["appearance"]["psnr_db"], report["appearance"]["psnr_db"]);
  // Few theta were measured: a G that leaps at these makes rings.
  const FactorModel model = ReadModel(In("isotropic/model.json")).model;
  const std::span<const double> G = model.table(Factor::kG, 0);
  ASSERT_EQ(G.size(), 9U);
  const double most = *std::ranges::max_element(G);
  const auto at = [&](int degrees) {
    return model.spec().g_axis.At(DegreesToRadians(degrees), 0)(G);
  };
  for (int k = 1; k < 70; ++k) EXPECT_NEAR(at(k), at(k - 1), 0.1 * most) << k;
}

// Between the six measured theta, only the prior determines D and F.
TEST_F(AnisotropicCommands, IsotropicFitIsGuidedBetweenTheDirections) {
  const auto psnr_from_formula = [&](const char* prior) {
    const ProgramResult fit =
        RunProgram({"fit", "synth:linen@6x12", "--model=isotropic", "--lobes=1", "--solver=varpro",
                    prior, "--noplots", "--out=" + In("with_prior")});
    EXPECT_EQ(fit.status, 0) << fit.err;
    return Parse(Contents(
        In("with_prior/report.json")))["appearance"]["from_formula"]["fitted"]["psnr_db"]
        .get<double>();
  };
  EXPECT_GT(psnr_from_formula("--prior=1"), psnr_from_formula("--prior=0") + 6);
  ExpectRefusal({"fit", "synth:plastic@30x30x60", "--prior=2"},
                "--prior is for scattered samples, and a ");
}

TEST_F(AnisotropicCommands, FitWritesItsCourseAndTheTablesThatItFitted) {
  const ProgramResult fit =
      RunProgram({"fit", "synth:charmeuse@4x12", "--lobes=1", "--convergence", "--max_iterations=3",
                  "--noplots", "--out=" + In("convergence")});
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(Contents(In("convergence/convergence.csv")),
              StartsWith("iteration,seconds,objective,"));
  EXPECT_EQ(ReadModel(In("convergence/model.json")).model.spec().f_axis.size, 6);
}

TEST_F(AnisotropicCommands, InfoGivesNodesAndAlbedosAlongAndAcross) {
  const std::string model = In("fit/model.json");
  const ProgramResult text = RunProgram({"info", model});
  ASSERT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("anisotropic model, 1 lobes"));
  EXPECT_THAT(text.out, HasSubstr("(4 theta to 75 deg x 12 phi)"));
  EXPECT_THAT(text.out, HasSubstr("directional albedo, light along y"));
  const json info = Parse(RunProgram({"info", model, "--json"}).out);
  EXPECT_TRUE(info["anisotropic"]);
  EXPECT_EQ(info["albedo"]["red"].size(), info["albedo_across"]["red"].size());
  EXPECT_NE(info["albedo"]["red"], info["albedo_across"]["red"]);
}

TEST_F(AnisotropicCommands, FitOfManyMakesThumbnails) {
  const ProgramResult many =
      RunProgram({"fit", kVelvet, "synth:linen@4x12", "--lobes=1", "--d_nodes=4x12",
                  "--g_nodes=4x12", "--solver=awls", "--max_iterations=2", "--out=" + In("many")});
  ASSERT_EQ(many.status, 0) << many.out << many.err;
  EXPECT_THAT(Contents(In("many/linen/pair.png")), StartsWith("\x89PNG\r\n"));
  EXPECT_THAT(Contents(In("many/index.html")), HasSubstr("linen/pair.png"));
}

TEST_F(AnisotropicCommands, WhatCannotBeIsOneLine) {
  const std::string model = In("fit/model.json");
  ExpectRefusal({"plot", model, "synth:plastic@30x30x60", "--out=" + In("p")}, "knows no azimuths");
  ExpectRefusal({"score", model, "synth:plastic@30x30x60"}, "knows no azimuths");
  ExpectRefusal({"fit", "synth:plastic@30x30x60", "--init=" + model}, "knows no azimuths");
  ExpectRefusal({"fit", kSilk, "--model=auto", "--nodes=held_out"}, "auto chooses the nodes");
  ExpectRefusal({"compare", In("fit")}, "plan.json");
}

TEST_F(AnisotropicCommands, ASceneNeedsLess) {
  std::ofstream(In("scene.json")) << R"({"format": "trilobe-scene", "version": 1,
      "budget": {"psnr_drop_db": 3}, "materials": [
      {"name": "curtain", "source": "synth:velvet@4x8", "directions": {"theta_i": [0, 50]}},
      {"name": "round", "source": "synth:felt@4x8"}]})";
  const std::string quick = "--lobes=1", cache = "--cache=" + In("cache");
  const ProgramResult fit =
      RunProgram({"fit", "--scene=" + In("scene.json"), quick, cache, "--out=" + In("scene")});
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("not taken: isotropic instead of anisotropic"));
  EXPECT_THAT(fit.out, HasSubstr("note:     isotropic: turned about its normal"));
  const json plan = Parse(Contents(In("scene/plan.json")));
  for (const json& material : plan["materials"]) {
    EXPECT_LT(material["parameters"]["pruned"], material["parameters"]["full"]);
    EXPECT_LE(material["psnr_db"]["full"].get<double>() - 3,
              material["psnr_db"]["pruned"].get<double>() + 1e-9);
  }
  const ProgramResult info = RunProgram({"info", In("scene/curtain.json"), "--json"});
  EXPECT_TRUE(Parse(info.out)["anisotropic"]) << info.err;
  const ProgramResult score = RunProgram({"score", In("scene/curtain.json"), "synth:velvet@4x8"});
  EXPECT_EQ(score.status, 0) << score.err;
  const ProgramResult compare = RunProgram({"compare", In("scene.json"), quick, cache});
  EXPECT_EQ(compare.status, 0) << compare.err;
  EXPECT_THAT(compare.out, HasSubstr("curtain"));
}

// The report says what was tried; the model has the nodes that were chosen.
TEST_F(AnisotropicCommands, FitChoosesNodesByHeldOutDirections) {
  const std::vector<std::string> command = {
      "fit",      kVelvet, "--lobes=1", "--solver=awls", "--nodes=held_out", "--max_iterations=2",
      "--verbose"};
  const auto fit_into = [&](const std::string& name, const char* threads) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), {"--noplots", "--out=" + In(name), threads});
    const ProgramResult fit = RunProgram(arguments);
    EXPECT_EQ(fit.status, 0) << fit.err;
    EXPECT_THAT(fit.out, HasSubstr("nodes        chosen by error on held-out directions: D "));
    return Parse(Contents(In(name + "/report.json")));
  };
  const json one = fit_into("chosen1", "--threads=1"), three = fit_into("chosen3", "--threads=3");
  const json& tried = one["nodes"]["tried"];
  ASSERT_GE(tried.size(), 2U);
  EXPECT_EQ(tried[0]["name"], "D 8rx12, G 6x6");
  EXPECT_EQ(one["nodes"]["chosen"], three["nodes"]["chosen"]);
  EXPECT_EQ(one["objective"], three["objective"]);
  size_t chosen = 0;
  while (chosen < tried.size() && tried[chosen]["name"] != one["nodes"]["chosen"]) ++chosen;
  ASSERT_LT(chosen, tried.size());
  for (const json& candidate : tried) {
    EXPECT_LE(tried[chosen]["relative_objective"],
              1.02 * candidate["relative_objective"].get<double>());
  }
  const json model = Parse(Contents(In("chosen1/model.json")));
  EXPECT_EQ(model["theta_nodes"]["D"].size(), 8 + 4 * chosen);
  EXPECT_TRUE(Parse(Contents(In("fit/report.json")))["nodes"].is_null());
}

// The report says what was tried; the model is of the form that looks best, within the budget.
TEST_F(AnisotropicCommands, FitChoosesTheFormThatLooksBest) {
  const ProgramResult fit =
      RunProgram({"fit", "synth:shot_silk@4x12", "--model=auto", "--lobes=1",
                  "--max_parameters=300", "--solver=awls", "--max_iterations=2", "--nodiagnose",
                  "--convergence", "--verbose", "--noplots", "--out=" + In("form")});
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("the best of "));
  EXPECT_THAT(fit.out, HasSubstr("<- chosen"));
  const json report = Parse(Contents(In("form/report.json")));
  const json& candidates = report["candidates"];
  ASSERT_GE(candidates.size(), 3U);
  EXPECT_EQ(candidates[0]["name"], "as fitted");
  const auto score = [](const json& candidate) { return candidate["psnr_db"].get<double>(); };
  const json& best = *std::ranges::max_element(candidates, {}, score);
  EXPECT_GT(score(best), score(candidates[0]) + 0.5);
  EXPECT_EQ(report["stored_parameters"], best["parameters"]);
  EXPECT_EQ(ReadModel(In("form/model.json")).model.spec().num_parameters(), best["parameters"]);
  for (const json& candidate : candidates) EXPECT_LE(candidate["parameters"], 300);
}

TEST_F(AnisotropicCommands, RefuseToChooseNodesWhereThereIsNothingToChoose) {
  ExpectRefusal({"fit", kSilk, "--nodes=all"}, "--nodes=all: give auto, given or held_out");
  ExpectRefusal({"fit", kSilk, "--nodes=held_out", "--d_nodes=4x12"}, "leave out --d_nodes");
  ExpectRefusal({"fit", kSilk, "--stretch=0.1,0.2"}, "--stretch is for isotropic models");
  ExpectRefusal({"fit", kSilk, "--nodes=held_out", "--model=isotropic"},
                "--nodes is for anisotropic models");
  ExpectRefusal({"fit", "synth:plastic@30x30x60", "--nodes=held_out"},
                "--nodes is for anisotropic models");
  ExpectRefusal({"fit", kSilk, "--nodes=held_out", "--init=" + In("fit/model.json")},
                "brings its own lobes and tables");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
