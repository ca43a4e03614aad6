// `trilobe measure` as a person sees it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/app/run_program.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Measure, PrintsOrWritesDirections) {
  const TemporaryFolder folder;
  const ProgramResult printed = RunProgram({"measure", "--directions=7"});
  EXPECT_EQ(printed.status, 0) << printed.err;
  EXPECT_THAT(printed.out, StartsWith("# Directions to measure [degrees], by trilobe "));
  EXPECT_EQ(std::ranges::count(printed.out, '\n'), 2 + 7);
  const std::string plan = folder / "plan.csv";
  EXPECT_THAT(RunProgram({"measure", "--directions=7", "--out=" + plan}).out,
              HasSubstr("7 pairs of directions"));
  EXPECT_EQ(Contents(plan), printed.out);
  // A model has values there, which are a measurement.
  const std::string values = folder / "values.csv";
  const ProgramResult at =
      RunProgram({"convert", "material:satin_purple", "--at=" + plan, "--out=" + values});
  EXPECT_EQ(at.status, 0) << at.err;
  EXPECT_THAT(RunProgram({"info", values}).out, HasSubstr("samples                   7"));
}

TEST(Measure, GoesAShortWay) {
  const auto lines_of = [](const std::string& path) {
    const ProgramResult result = RunProgram({"measure", "--directions=20", path});
    EXPECT_EQ(result.status, 0) << result.err;
    std::istringstream text(result.out);
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    std::ranges::sort(lines);
    return std::pair(lines, result.out);
  };
  const auto [plan, in_plan] = lines_of("--path=");
  const auto [path, along_path] = lines_of("--path=1,1,2");
  EXPECT_EQ(plan, path);
  EXPECT_NE(in_plan, along_path);
  const TemporaryFolder folder;
  EXPECT_THAT(RunProgram({"measure", "--path=1,1,1", "--out=" + (folder / "p.csv")}).out,
              HasSubstr(" % of the way through the plan"));
}

// What somebody has measured is not lost.
TEST(Measure, OverwritesNoPlanWithValues) {
  const TemporaryFolder folder;
  const std::string plan = folder / "plan.csv";
  for (const char* const count : {"--directions=3", "--directions=5"}) {
    EXPECT_EQ(RunProgram({"measure", count, "--out=" + plan}).status, 0);
  }
  std::ofstream(plan) << "# Directions to measure [degrees], by trilobe 0.2.0\n"
                         "theta_i,phi_i,theta_o,phi_o,r,g,b\n10,0,10,180,1,1,1\n";
  const std::string filled = Contents(plan);
  const ProgramResult again = RunProgram({"measure", "--out=" + plan});
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.err, HasSubstr("--force"));
  EXPECT_EQ(Contents(plan), filled);
}

TEST(Measure, SaysWhatIsNext) {
  const TemporaryFolder folder;
  const std::string plan = folder / "plan.csv", values = folder / "values.csv";
  RunProgram({"measure", "--directions=40", "--out=" + plan});
  RunProgram({"convert", "material:satin_purple", "--at=" + plan, "--out=" + values});
  const ProgramResult printed = RunProgram({"measure", values, "--next=4"});
  EXPECT_EQ(printed.status, 0) << printed.err;
  EXPECT_THAT(printed.out, StartsWith("# Directions to measure [degrees], by trilobe "));
  EXPECT_EQ(std::ranges::count(printed.out, '\n'), 2 + 4);
  EXPECT_THAT(printed.err, HasSubstr("a fit to 40 directions is off by about Delta E "));
  const std::string next = folder / "next.csv";
  const ProgramResult written = RunProgram({"measure", values, "--next=4", "--out=" + next});
  EXPECT_THAT(written.out, HasSubstr("with these, by about "));
  EXPECT_THAT(written.out, HasSubstr("4 pairs of directions [degrees]"));
  EXPECT_EQ(Contents(next), printed.out);
  EXPECT_NE(RunProgram({"measure", values, "--next=4", "--by=design"}).out, printed.out);
  const std::string measured = Contents(values);
  EXPECT_EQ(RunProgram({"measure", values, "--next=4", "--out=" + values}).status, 1);
  EXPECT_EQ(Contents(values), measured);
}

TEST(Measure, WhatCannotBeNextIsOneLine) {
  const TemporaryFolder folder;
  const std::string few = folder / "few.csv";
  std::ofstream(few) << "theta_i,phi_i,theta_o,phi_o,r,g,b\n10,0,10,180,1,1,1\n20,0,10,180,1,1,1\n";
  const auto error = [](const std::vector<std::string>& arguments) {
    std::vector<std::string> words = {"measure"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const ProgramResult result = RunProgram(words);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    return result.err;
  };
  EXPECT_THAT(error({few, "--next=5"}), HasSubstr("at least 10 samples, and there are 2"));
  EXPECT_THAT(error({few}), HasSubstr("--next=10"));
  EXPECT_THAT(error({"--next=5"}), HasSubstr("SOURCE"));
  EXPECT_THAT(error({few, "--next=5", "--by=luck"}), HasSubstr("plan, design or both"));
  EXPECT_THAT(error({few, "--next=5", "--directions=9"}), HasSubstr("leave one out"));
  EXPECT_THAT(error({"synth:plastic@9x9x18", "--next=5"}), HasSubstr("measured everywhere"));
  EXPECT_THAT(error({"synth:linen@3x8", "--next=5"}), HasSubstr("isotropic"));
  EXPECT_THAT(error({folder / "none.csv", "--next=5"}), HasSubstr("none.csv"));
}

TEST(Measure, WhatCannotBeIsOneLine) {
  const TemporaryFolder folder;
  const auto error = [](const std::string& flag) {
    const ProgramResult result = RunProgram({"measure", flag});
    EXPECT_EQ(result.status, 1) << flag;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    return result.err;
  };
  EXPECT_THAT(error("--directions=0"), HasSubstr("give 1 to 100000"));
  EXPECT_THAT(error("--incidences=10,x"), HasSubstr("--incidences=10,x: give angles in degrees"));
  EXPECT_THAT(error("--incidences=85"), HasSubstr("from 0 to theta_max, 80"));
  EXPECT_THAT(error("--theta_max=nan"), HasSubstr("theta"));
  EXPECT_THAT(error("--path=1,2"), HasSubstr("theta_i, theta_o and phi takes, as 1,1,2"));
  EXPECT_THAT(error("--path=1,2,-1"), HasSubstr("0 or more"));
  EXPECT_THAT(error("--out=" + (folder / "x.json")), HasSubstr("end the name in .csv"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
