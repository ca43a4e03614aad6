// `trilobe fit` as a script or a person sees it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/run_on_terminal.h"
#include "tests/app/run_program.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/trace_file.h"

namespace trilobe {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

nlohmann::json Json(const std::string& path) { return nlohmann::json::parse(Contents(path)); }

std::vector<std::string> Fit(const std::string& out, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"fit",           "synth:plastic",      "--noise=0.02",
                                        "--solver=awls", "--max_iterations=3", "--nodiagnose",
                                        "--out=" + out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(Fit, WritesModelTraceAndReport) {
  const TemporaryFolder folder;
  const std::string out = folder / "a/b";  // parents are made
  const ProgramResult result = RunProgram(Fit(out, {"--reconstruction", "--diagnose"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");  // no progress line in a pipe

  const ModelFile file = ReadModel(out + "/model.json");
  EXPECT_EQ(file.model.spec(), ModelSpec::SharedFactors(3));
  EXPECT_EQ(file.fit.solver, "awls");
  EXPECT_EQ(file.fit.iterations, 3);

  EXPECT_THAT(Contents(out + "/trace.csv"), StartsWith("iteration,seconds,objective"));
  const std::vector<IterationRecord> trace = ReadTrace(out + "/trace.csv");
  ASSERT_EQ(trace.size(), 4U);
  EXPECT_EQ(trace[0].iteration, 0);
  EXPECT_LT(trace[3].objective, trace[0].objective);
  EXPECT_NEAR(file.fit.objective, trace[3].objective, 1e-12 * trace[3].objective);

  const nlohmann::json report = Json(out + "/report.json");
  EXPECT_EQ(report["objective"].get<double>(), file.fit.objective);
  EXPECT_EQ(report["stop_reason"], "max_iterations");
  EXPECT_EQ(report["best_iteration"], 3);
  EXPECT_EQ(report["rejected_steps"], 0);
  EXPECT_EQ(report["options"]["given"]["max_iterations"], 3);
  EXPECT_TRUE(report["options"]["given"]["max_seconds"].is_null());  // no limit
  EXPECT_EQ(report["options"]["used"]["g_filter_sigma"], 0);
  EXPECT_FALSE(report["options"]["used"].contains("memory"));  // awls does not read it
  EXPECT_TRUE(report["notes"].is_array());
  EXPECT_TRUE(report["starts"].is_array());
  EXPECT_EQ(report["phases"]["reading"], report["seconds"]["read"]);
  EXPECT_GT(report["phases"]["evaluating"], 0);
  EXPECT_GT(report["peak_memory_bytes"], 35e6);  // the values alone
  ASSERT_TRUE(report.contains("diagnosis"));
  EXPECT_FALSE(report["diagnosis"].contains("gradient"));
  for (const char* const line : {"solver       awls: 3 iterations", "options      max_iterations 3",
                                 "phases       ", "error        E is "}) {
    EXPECT_THAT(result.out, HasSubstr(line));
  }

  const BrdfTable fitted = ReadMerl(out + "/reconstruction.binary");
  const int bin = fitted.grid.Index(10, 20, 90);
  const double expected =
      Evaluate(file.model, GridStencils(file.model.spec(), fitted.grid, bin), 1);
  EXPECT_NEAR(fitted.Value(1, bin), expected, 1e-12 * expected);

  // `score` finds the very objective that the fit reported.
  const ProgramResult score =
      RunProgram({"score", out + "/model.json", "synth:plastic", "--noise=0.02", "--json"});
  ASSERT_EQ(score.status, 0) << score.err;
  EXPECT_EQ(nlohmann::json::parse(score.out)["objective"].get<double>(), file.fit.objective);
}

TEST(Fit, CourseScoresTheModelsOnTheWay) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  ASSERT_EQ(RunProgram(Fit(out, {"--course"})).status, 0);
  const std::vector<IterationRecord> trace = ReadTrace(out + "/trace.csv");
  const nlohmann::json report = Json(out + "/report.json");
  std::istringstream course(Contents(out + "/course.csv"));
  std::string line;
  ASSERT_TRUE(std::getline(course, line));
  EXPECT_EQ(line, "iteration,seconds,objective,psnr_db,rmse,mean_relative_error,mean_log_error");
  int rows = 0, iteration = -1;
  double seconds = -1, objective = 0, psnr_db = 0;
  while (std::getline(course, line)) {
    const double before = seconds;
    ASSERT_EQ(
        std::sscanf(line.c_str(), "%d,%lf,%lf,%lf", &iteration, &seconds, &objective, &psnr_db), 4);
    ASSERT_LT(iteration, static_cast<int>(trace.size()));
    EXPECT_EQ(iteration == 0, rows++ == 0);
    EXPECT_EQ(seconds, trace[iteration].seconds);
    EXPECT_GT(seconds, before);
    EXPECT_EQ(objective, trace[iteration].objective);
  }
  EXPECT_EQ(iteration, trace.back().iteration);
  EXPECT_NEAR(psnr_db, report["psnr_db"].get<double>(), 1e-9);  // that one is in canonical form
}

TEST(Fit, RepeatsToTheBitAndThreadsAgree) {
  const TemporaryFolder folder;
  std::vector<FactorModel> models;
  for (const char* threads : {"1", "1", "2"}) {
    const std::string out = folder / std::to_string(models.size());
    ASSERT_EQ(RunProgram(Fit(out, {std::string("--threads=") + threads})).status, 0);
    models.push_back(ReadModel(out + "/model.json").model);
  }
  for (size_t k = 1; k < models.size(); ++k) {
    EXPECT_THAT(models[k].parameters(), ::testing::ElementsAreArray(models[0].parameters()));
  }
}

TEST(Fit, GoesOnFromAModelFile) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "first", {"--lobes=2"})).status, 0);
  const std::string model = folder / "first/model.json";
  ASSERT_EQ(RunProgram(Fit(folder / "second", {"--init=" + model})).status, 0);
  const auto first = ReadTrace(folder / "first/trace.csv");
  const auto second = ReadTrace(folder / "second/trace.csv");
  EXPECT_NEAR(second[0].objective, first.back().objective, 1e-10 * first.back().objective);
  EXPECT_LT(second.back().objective, first.back().objective);

  const ProgramResult other = RunProgram(Fit(folder / "third", {"--init=" + model, "--lobes=3"}));
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.err, HasSubstr("--lobes"));
}

TEST(Fit, FitsTheOneLobeModelThatSharesNothing) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "out", {"--model=independent"})).status, 0);
  EXPECT_EQ(ReadModel(folder / "out/model.json").model.spec().num_parameters(), 816);
}

TEST(Fit, CtrlCKeepsTheBestModelSoFar) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const TerminalResult result =
      RunOnTerminal(Fit(out, {"--max_iterations=1000000", "--tolerance=0"}), "iteration 2", SIGINT);
  EXPECT_EQ(result.status, 130);
  EXPECT_THAT(result.text, HasSubstr("interrupted"));
  EXPECT_THAT(result.text, HasSubstr("s left"));  // the progress line of a terminal
  const auto trace = ReadTrace(out + "/trace.csv");
  ASSERT_GE(trace.size(), 3U);
  const ModelFile file = ReadModel(out + "/model.json");
  EXPECT_EQ(file.fit.stop_reason, "interrupted");
  EXPECT_NEAR(file.fit.objective, trace.back().objective, 1e-12 * trace.back().objective);
}

TEST(Fit, HonoursItsTimeLimit) {
  const TemporaryFolder folder;
  const ProgramResult result = RunProgram(
      Fit(folder / "out", {"--max_iterations=1000000", "--tolerance=0", "--max_seconds=0.5"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto trace = ReadTrace(folder / "out/trace.csv");
  EXPECT_GE(trace.back().seconds, 0.5);
  // On a slow machine the start alone may take that long.
  for (size_t k = 0; k + 1 < trace.size(); ++k) EXPECT_LT(trace[k].seconds, 0.5);
}

// Every common flag arrives where it should; in nodes of 1 degree, --g_filter is its own number.
TEST(Fit, HandsItsFlagsToTheSolver) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "out",
                           {"--solver=awls", "--max_iterations=0", "--max_seconds=7",
                            "--tolerance=0.5", "--optimality_tolerance=1e-3", "--g_filter=2"}))
                .status,
            0);
  const nlohmann::json report = Json(folder / "out/report.json");
  EXPECT_EQ(report["options"]["given"], nlohmann::json({{"max_iterations", 0},
                                                        {"max_seconds", 7.0},
                                                        {"relative_decrease_tolerance", 0.5},
                                                        {"optimality_tolerance", 1e-3},
                                                        {"diagnose", false},
                                                        {"g_filter_sigma", 2.0}}));
  EXPECT_TRUE(report["diagnosis"].is_null());
}

struct BadInput {
  std::vector<std::string> flags;
  std::string message;  // part of it
};

TEST(Fit, RefusesBadInputInOneLineAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const std::vector<BadInput> cases = {
      {{"--solver=x"}, "known: auto, "},
      {{"--weighting=x"}, "known: compressive, log, percentage, cosine, uniform"},
      {{"--init=x"}, "known: "},
      {{"--init=/nowhere/model.json"}, "/nowhere/model.json"},
      {{"--model=x"}, "known: shared, independent"},
      {{"--model=independent", "--lobes=2"}, "--lobes"},
      {{"--lobes=-1"}, "lobes is -1"},
      {{"--lobes=9"}, "lobes is 9"},
      {{"--max_iterations=-1"}, "--max_iterations"},
      {{"--max_seconds=-1"}, "--max_seconds"},
      {{"--max_seconds=nan"}, "--max_seconds"},
      {{"--tolerance=1"}, "--tolerance"},
      {{"--optimality_tolerance=nan"}, "--optimality_tolerance"},
      {{"--g_filter=-1"}, "--g_filter"},
      {{"--solver=awls", "--starts=2"}, "awls does not take --starts; it takes --g_filter"},
      {{"--solver=awls", "--memory=3"}, "does not take --memory"},
      {{"--solver=awls", "--positivity=squares"}, "does not take --positivity"},
      {{"--solver=awls", "--trust_region=dogleg"}, "does not take --trust_region"},
      {{"--threads=-1"}, "--threads"},
      {{"--noise=2"}, "noise"},
      {{"--json"}, "no flag --json"},
      {{"two", "arguments"}, "takes SOURCE"},
  };
  for (const BadInput& bad : cases) {
    SCOPED_TRACE(bad.flags[0]);
    const ProgramResult result = RunProgram(Fit(out, bad.flags));
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, StartsWith("trilobe: error: "));
    EXPECT_THAT(result.err, HasSubstr(bad.message));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST(Fit, SaysSoWhenItsReportIsLost) {
  const TerminalResult result = RunOnTerminal({"synth"}, "", 0);
  EXPECT_EQ(result.status, 0);
  // The same with standard output on a full disk.
  const pid_t pid = fork();
  if (pid == 0) {
    const int full = open("/dev/full", O_WRONLY);
    if (dup2(full, STDOUT_FILENO) < 0 || dup2(full, STDERR_FILENO) < 0) _exit(126);
    execl(TRILOBE_PROGRAM, TRILOBE_PROGRAM, "synth", nullptr);
    _exit(127);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

TEST(Fit, ReportsTheModelThatAStartBroughtAlong) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "first", {"--model=independent"})).status, 0);
  const std::string init = "--init=" + (folder / "first/model.json");
  ASSERT_EQ(RunProgram(Fit(folder / "second", {init})).status, 0);
  EXPECT_EQ(Json(folder / "second/report.json")["model"], "independent");
}

TEST(Fit, PrefersANameToAFolderOfThatName) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "constant");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(std::filesystem::path(folder / "constant").parent_path());
  const ProgramResult result = RunProgram(Fit(folder / "out", {"--init=constant"}));
  std::filesystem::current_path(before);
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST(Fit, KeepsEarlierResultsWhenTheFolderIsAFile) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "out")).status, 0);
  const std::string before = Contents(folder / "out/model.json");
  const ProgramResult result = RunProgram(Fit(folder / "out/model.json"));
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("model.json"));
  EXPECT_EQ(Contents(folder / "out/model.json"), before);
}

}  // namespace
}  // namespace trilobe
