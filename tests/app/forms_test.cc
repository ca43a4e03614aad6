// `trilobe forms`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/app/run_program.h"
#include "trilobe/model/evaluate/read_terms.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(Forms, AreFittedComparedAndRead) {
  const TemporaryFolder folder;
  const std::string table = "synth:foam@16x15x24", fit = folder / "fit", out = folder / "forms";
  ASSERT_EQ(RunProgram({"fit", table, "--out=" + fit, "--noplots", "--solver=awls",
                        "--max_iterations=5", "--lobes=1"})
                .status,
            0);
  const ProgramResult forms = RunProgram(
      {"forms", fit + "/model.json", table, "--forms=diffuse_table, retro", "--out=" + out});
  ASSERT_EQ(forms.status, 0) << forms.err;
  EXPECT_THAT(forms.out, HasSubstr("\npaper "));
  EXPECT_THAT(forms.out, HasSubstr("\ndiffuse_table "));
  EXPECT_THAT(forms.out, HasSubstr("\nretro "));
  const json report = json::parse(Contents(out + "/forms.json"))["forms"];
  ASSERT_EQ(report.size(), 3);
  EXPECT_EQ(report[0]["of_paper"], 1);
  // It has more numbers, and begins where the paper's does.
  EXPECT_LT(report[1]["of_paper"], 1.01);
  EXPECT_EQ(report[1]["parameters"], report[0]["parameters"].get<int>() + 12);
  EXPECT_EQ(ReadTerms(out + "/retro.json").model.spec().terms.back().name, "retroreflection");

  // Its values, as a measurement of other commands.
  const ProgramResult info = RunProgram({"info", out + "/diffuse_table.json"});
  EXPECT_EQ(info.status, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("a model of terms"));

  // Another run takes the place of this one, and files of nobody's are left alone.
  ASSERT_EQ(
      RunProgram({"forms", fit + "/model.json", table, "--forms=paper", "--out=" + out}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(out + "/retro.json"));
}

TEST(Forms, WhatCannotBeIsSaid) {
  const auto error_of = [](const std::vector<std::string>& arguments) {
    const ProgramResult result = RunProgram(arguments);
    EXPECT_NE(result.status, 0);
    return result.err;
  };
  EXPECT_THAT(error_of({"forms", "material:aurora_white", "synth:felt", "--forms=harmonic"}),
              HasSubstr("unknown form 'harmonic'; known: paper, diffuse_table"));
  const TemporaryFolder samples;
  std::ofstream(samples / "one.csv") << "theta_i,phi_i,theta_o,phi_o,f\n0,0,10,0,0.1\n";
  EXPECT_THAT(error_of({"forms", "material:aurora_white", samples / "one.csv", "--forms=retro"}),
              HasSubstr("too few directions to hold out some of them, as --model=auto"));
  EXPECT_THAT(error_of({"forms", "material:aurora_white", samples / "one.csv"}),
              HasSubstr("form own_f: each lobe has an F of its own already; leave it out"));
  EXPECT_THAT(error_of({"forms", "synth:felt", "synth:felt"}),
              HasSubstr("this is a measurement; a model is a model.json"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
