// `trilobe study`: solvers compared by one command.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/app/run_program.h"
#include "tests/paths.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kSource = "synth:copper@12x12x24";

class Study : public ::testing::Test {
 protected:
  ProgramResult RunStudy(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {
        "study", kSource, "--noise=0.02", "--max_iterations=4", "--nodiagnose", "--out=" + out_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(arguments);
  }

  const TemporaryFolder folder_;
  const std::string out_ = folder_ / "out";
};

TEST_F(Study, ComparesSolversGoesOnAndKeeps) {
  const std::vector<std::string> flags = {"--solvers=awls,lm", "--runs=2"};
  const ProgramResult first = RunStudy(flags);
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("[4/4] "));
  EXPECT_THAT(first.out, HasSubstr("E never rose in 16 iterations of all methods."));
  for (const char* const name : {"index.html", "runs.csv", "methods.csv", "traces.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(out_ + "/" + name)) << name;
  }
  const std::string page = Contents(out_ + "/index.html");
  EXPECT_THAT(page, HasSubstr("trilobe study synth:copper@12x12x24 --"));
  EXPECT_THAT(page, HasSubstr("copper/awls/start-2/report.json"));
  EXPECT_THAT(page, HasSubstr("Content-Security-Policy"));

  // A study compares raw fits: the reported E is the solver's.
  const auto report = nlohmann::json::parse(Contents(out_ + "/copper/awls/start-1/report.json"));
  EXPECT_TRUE(report.at("raw"));
  EXPECT_DOUBLE_EQ(report.at("objective"), report.at("solver_objective"));
  const std::string runs = Contents(out_ + "/runs.csv");
  EXPECT_EQ(std::ranges::count(runs, '\n'), 5);

  const ProgramResult again = RunStudy(flags);
  EXPECT_THAT(again.out, HasSubstr("copper, lm, start 2: kept"));
  EXPECT_EQ(Contents(out_ + "/runs.csv"), runs);
  std::filesystem::remove_all(out_ + "/copper/lm/start-2");
  // A damaged result is made again.
  std::filesystem::resize_file(out_ + "/copper/awls/start-1/trace.csv", 30);  // in its header
  const ProgramResult third = RunStudy(flags);
  EXPECT_THAT(third.out, HasSubstr("copper, awls, start 1: fitted"));
  EXPECT_THAT(third.out, HasSubstr("copper, lm, start 2: fitted"));
  EXPECT_THAT(third.out, HasSubstr("copper, lm, start 1: kept"));
}

TEST_F(Study, StartsDifferOnTheSameData) {
  ASSERT_EQ(RunStudy({"--solvers=awls", "--starts=3"}).status, 0);
  const auto report = [&](int start) {
    return nlohmann::json::parse(
        Contents(out_ + "/copper/awls/start-" + std::to_string(start) + "/report.json"));
  };
  EXPECT_NE(report(2).at("initial_objective"), report(3).at("initial_objective"));
  EXPECT_EQ(report(2).at("valid_samples"), report(3).at("valid_samples"));
  EXPECT_EQ(report(1).at("init"), "analytic");
  EXPECT_EQ(report(3).at("init"), "random");
  EXPECT_EQ(report(3).at("seed"), 3);
  EXPECT_EQ(report(3).at("data_seed"), 1);
  std::filesystem::remove_all(out_);
  ASSERT_EQ(RunStudy({"--solvers=awls", "--runs=2", "--init=random", "--seed=5"}).status, 0);
  EXPECT_EQ(report(1).at("seed"), 5);
  EXPECT_EQ(report(2).at("seed"), 6);
  EXPECT_EQ(report(2).at("data_seed"), 5);
}

TEST_F(Study, AnotherStudyIsNotWrittenOver) {
  const std::vector<std::string> lobes = {"--solvers=awls", "--runs=1", "--set=lobes=1,2"};
  ASSERT_EQ(RunStudy(lobes).status, 0);
  const std::string runs = Contents(out_ + "/runs.csv");
  const auto refused = [&](const std::vector<std::string>& flags) {
    const ProgramResult result = RunStudy(flags);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(Contents(out_ + "/runs.csv"), runs);
    return result.err;
  };
  // Tables of other runs; and the same runs with other settings.
  EXPECT_THAT(refused({"--solvers=awls", "--runs=1", "--set=weighting=log,cosine"}),
              HasSubstr("another study, whose results this one would replace: trilobe study "
                        "synth:copper@12x12x24 --"));
  EXPECT_THAT(refused({"--solvers=awls", "--runs=1", "--set=lobes=1,2", "--tolerance=1e-3"}),
              HasSubstr("another study"));
  // More runs, solvers or values are the same study.
  const ProgramResult more = RunStudy({"--solvers=awls,lm", "--runs=2", "--set=lobes=1,2,3"});
  EXPECT_EQ(more.status, 0) << more.err;
  EXPECT_THAT(more.out, HasSubstr("copper, awls lobes=2, start 1: kept"));
  // Without its record a table may be anybody's.
  std::filesystem::remove(out_ + "/study.json");
  EXPECT_THAT(RunStudy(lobes).err, HasSubstr("has tables without study.json"));
}

TEST_F(Study, ALimitIsToldWhereItStoppedRuns) {
  const ProgramResult limited = RunStudy({"--solvers=awls", "--runs=2"});
  EXPECT_THAT(limited.out, HasSubstr("2 of 2 stopped by --max_iterations"));
  EXPECT_THAT(Contents(out_ + "/index.html"), HasSubstr("2 of 2 stopped by --max_iterations"));
  EXPECT_THAT(Contents(out_ + "/methods.csv"), HasSubstr(",2 of 2 stopped by --max_iterations,"));
  // Without a limit of its own, a run has thirty seconds.
  const std::string out = folder_ / "free";
  const ProgramResult result = RunProgram(
      {"study", "synth:copper@8x8x8", "--solvers=lm", "--runs=1", "--nodiagnose", "--out=" + out});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto report = nlohmann::json::parse(Contents(out + "/copper/lm/start-1/report.json"));
  EXPECT_EQ(report.at("options").at("given").at("max_seconds"), 30);
  EXPECT_GT(report.at("options").at("given").at("max_iterations"), 1000000);
  EXPECT_THAT(Contents(out + "/index.html"), HasSubstr("30 s of each solver"));
}

TEST_F(Study, FormsAreJudgedByHeldOutSamples) {
  ASSERT_EQ(RunStudy({"--solvers=awls", "--runs=1", "--set=lobes=1,2"}).status, 0);
  const auto held_out = [&](const std::string& lobes) {
    const std::string report = out_ + "/copper/awls-lobes-" + lobes + "/start-1/report.json";
    return nlohmann::json::parse(Contents(report)).at("held_out");
  };
  const double one = held_out("1").at("relative_objective");
  const double two = held_out("2").at("relative_objective");
  EXPECT_THAT(Contents(out_ + "/index.html"),
              HasSubstr("Samples that were held out are predicted best by awls lobes=" +
                        std::string(one < two ? "1" : "2")));
  EXPECT_THAT(Contents(out_ + "/runs.csv"),
              HasSubstr("," + held_out("1").at("mean_delta_e").dump()));
  // Solvers of the same form are not judged by it unless asked to.
  const std::string out = folder_ / "solvers";
  ASSERT_EQ(RunStudy({"--solvers=awls", "--runs=1", "--out=" + out}).status, 0);
  EXPECT_TRUE(nlohmann::json::parse(Contents(out + "/copper/awls/start-1/report.json"))
                  .at("held_out")
                  .is_null());
}

TEST_F(Study, ThePageSaysHowItWasMade) {
  ASSERT_EQ(RunStudy({"--solvers=awls", "--runs=1"}).status, 0);
  const std::string page = Contents(out_ + "/index.html");
  const auto report = nlohmann::json::parse(Contents(out_ + "/copper/awls/start-1/report.json"));
  const std::string samples = report.at("valid_samples").dump();
  EXPECT_THAT(page, HasSubstr(samples + " samples, weighting appearance, "));
  EXPECT_THAT(page, HasSubstr("1, one run at a time"));
  EXPECT_THAT(page, HasSubstr(report.at("program").get<std::string>()));
  EXPECT_THAT(page, HasSubstr(report.at("date").get<std::string>()));
  EXPECT_THAT(page, HasSubstr("--max_iterations=4"));
  EXPECT_EQ(report.at("machine").at("side_by_side"), 1);
}

TEST_F(Study, ThreeProblemsHaveProfiles) {
  ASSERT_EQ(
      RunStudy({"synth:felt@12x12x24", "synth:foam@12x12x24", "--solvers=awls,lm", "--runs=1"})
          .status,
      0);
  EXPECT_THAT(Contents(out_ + "/profiles.csv"), HasSubstr("\nperformance,lm,1,"));
  EXPECT_THAT(Contents(out_ + "/index.html"), HasSubstr("data_profile.svg"));
}

TEST_F(Study, SweepsFlagsOfTheProblemAndOfSomeSolvers) {
  const ProgramResult result =
      RunStudy({"--solvers=awls,lm", "--runs=1",
                "--set=trust_region=levenberg_marquardt,dogleg;weighting=log,"
                "cosine;lobes=1"});
  ASSERT_EQ(result.status, 0) << result.err;
  // Each weighting is a problem with an E of its own; awls knows no trust region.
  EXPECT_TRUE(std::filesystem::exists(out_ + "/copper-log/awls-lobes-1/start-1/model.json"));
  EXPECT_TRUE(std::filesystem::exists(out_ + "/copper-cosine/lm-dogleg-lobes-1/start-1"));
  const std::string runs = Contents(out_ + "/runs.csv");
  EXPECT_EQ(std::ranges::count(runs, '\n'), 1 + 2 * 3);
  EXPECT_THAT(runs, HasSubstr("\ncopper log,lm dogleg lobes=1,1,"));
}

TEST_F(Study, AVariedStartIsRunOnce) {
  ASSERT_EQ(RunStudy({"--solvers=awls", "--runs=3", "--set=init=analytic, random"}).status, 0);
  EXPECT_TRUE(std::filesystem::exists(out_ + "/copper/awls-random/start-1"));
  EXPECT_FALSE(std::filesystem::exists(out_ + "/copper/awls-random/start-2"));
}

TEST_F(Study, TimesBeginWhereTheDataArePrepared) {
  ASSERT_EQ(RunStudy({"--solvers=awls", "--runs=1"}).status, 0);
  const auto seconds =
      nlohmann::json::parse(Contents(out_ + "/copper/awls/start-1/report.json")).at("seconds");
  const std::string traces = Contents(out_ + "/traces.csv");
  const size_t first = traces.find("\ncopper,awls,1,0,");
  ASSERT_NE(first, std::string::npos);
  EXPECT_GE(std::stod(traces.substr(first + std::string("\ncopper,awls,1,0,").size())),
            seconds.at("prepare").get<double>() + seconds.at("init").get<double>());
}

TEST_F(Study, OneFailureDoesNotStopTheOthers) {
  const std::string bad = folder_ / "bad.binary";
  std::ofstream(bad) << "no measurement";
  const ProgramResult result = RunStudy({bad, "--solvers=awls", "--runs=1"});
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.out, HasSubstr("copper, awls, start 1: fitted"));
  EXPECT_THAT(result.out, HasSubstr("bad, awls, start 1: failed: "));
  EXPECT_THAT(Contents(out_ + "/runs.csv"), HasSubstr("\nbad,awls,1,inf,inf,"));
  EXPECT_THAT(Contents(out_ + "/runs.csv"), Not(HasSubstr(folder_ / "")));
}

TEST_F(Study, ShardsMakeTheirRunsAlone) {
  const ProgramResult part = RunStudy({"--solvers=awls", "--runs=3", "--shard=2/3"});
  ASSERT_EQ(part.status, 0) << part.err;
  EXPECT_FALSE(std::filesystem::exists(out_ + "/index.html"));
  EXPECT_FALSE(std::filesystem::exists(out_ + "/copper/awls/start-1"));
  EXPECT_TRUE(std::filesystem::exists(out_ + "/copper/awls/start-2/report.json"));
  EXPECT_THAT(RunStudy({"--solvers=awls", "--runs=3"}).out, HasSubstr("start 2: kept"));
}

TEST_F(Study, SaysWhatIsWrongBeforeItBegins) {
  const auto error = [&](const std::vector<std::string>& flags) {
    const ProgramResult result = RunStudy(flags);
    EXPECT_EQ(result.status, 1);
    EXPECT_FALSE(std::filesystem::exists(out_));
    return result.err;
  };
  EXPECT_THAT(error({"--solvers=awls,no"}), HasSubstr("'no'"));
  EXPECT_THAT(error({"--solvers="}), HasSubstr("--solvers is empty"));
  EXPECT_THAT(error({"--solvers=awls,awls"}), HasSubstr("asked for twice"));
  EXPECT_THAT(error({"--runs=0"}), HasSubstr("--runs must be"));
  EXPECT_THAT(error({"--runs=2", "--starts=2"}), HasSubstr("another name of --runs"));
  EXPECT_THAT(error({"--set=lobes"}), HasSubstr("give values"));
  EXPECT_THAT(error({"--set=seed=1,2"}), HasSubstr("'seed' is no flag"));
  EXPECT_THAT(error({"--set=lobes=1,two"}), HasSubstr("--lobes=two"));
  EXPECT_THAT(error({"--set=lobes=1,2", "--lobes=3"}), HasSubstr("give one of them"));
  EXPECT_THAT(error({"--set=weighting=none"}), HasSubstr("none"));
  EXPECT_THAT(error({"--set=lobes=1;lobes=2"}), HasSubstr("varies --lobes twice"));
  EXPECT_THAT(error({"--solvers=awls", "--set=trust_region=dogleg"}),
              HasSubstr("none of --solvers reads"));
  EXPECT_THAT(error({folder_ / "nosuch.csv"}), HasSubstr("no such file"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
