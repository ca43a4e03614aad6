#include "fit/study/study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "fit/study/draw_study.h"
#include "io/pictures/gnuplot.h"
#include "tests/app/run_program.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr MerlGrid kGrid{.theta_h = 10, .theta_d = 9, .phi_d = 15};

// A run whose E falls to these values, one a second.
StudyRun RunOf(const std::string& method, int start, const std::vector<double>& objectives,
               uint64_t lobes = 1) {
  StudyRun run{.problem = "copper", .method = method, .start = start, .folder = method};
  for (size_t k = 0; k < objectives.size(); ++k) {
    run.trace.push_back({.iteration = static_cast<int>(k),
                         .seconds = static_cast<double>(k),
                         .objective = objectives[k]});
  }
  run.seconds = static_cast<double>(objectives.size());
  run.file.model = FactorModel(ModelSpec::SharedFactors(2, kGrid));
  Random random(lobes);
  for (double& x : run.file.model.parameters()) x = random.Uniform(0.01, 1);
  return run;
}

StudyRun FailedRun(const std::string& method, int start) {
  StudyRun run{.problem = "copper", .method = method, .start = start, .folder = method};
  run.error = "no such file";
  return run;
}

std::vector<StudyRun> Compared(std::vector<StudyRun> runs) {
  CompareRuns(&runs);
  return runs;
}

TEST(Study, ExcessIsRelativeToTheLowestOfTheProblem) {
  std::vector<StudyRun> runs = {RunOf("a", 1, {8, 2}), RunOf("b", 1, {8, 4, 3}), FailedRun("b", 2)};
  runs.push_back(RunOf("a", 1, {9, 1}));
  runs.back().problem = "felt";
  CompareRuns(&runs);
  EXPECT_EQ(runs[0].excess(), 0);
  EXPECT_EQ(runs[1].excess(), 0.5);
  EXPECT_TRUE(std::isinf(runs[2].excess()));
  EXPECT_EQ(runs[3].excess(), 0);
  EXPECT_EQ(LowestRun(runs, "copper"), runs.data());
}

TEST(Study, ExcessOfDataWithoutNoiseIsRelativeToRounding) {
  // Both have come to what rounding leaves of E = 1.
  const std::vector<StudyRun> runs =
      Compared({RunOf("a", 1, {1, 1e-20}), RunOf("b", 1, {1, 1e-17})});
  EXPECT_LT(runs[1].excess(), kTheSame);
  EXPECT_EQ(Compared({RunOf("a", 1, {0, 0})})[0].excess(), 0);
}

TEST(Study, SecondsToAnExcessAreThoseOfTheFirstRecordBelowIt) {
  const std::vector<StudyRun> runs =
      Compared({RunOf("a", 1, {8, 2.1, 2.01, 2}), RunOf("b", 1, {8, 4, 3})});
  EXPECT_EQ(runs[0].SecondsTo(0.01), 2);
  EXPECT_EQ(runs[0].SecondsTo(0.0), 3);
  EXPECT_TRUE(std::isinf(runs[1].SecondsTo(0.01)));
}

TEST(Study, SummaryCountsFailuresAsNeverSolved) {
  const std::vector<StudyRun> runs =
      Compared({RunOf("a", 1, {8, 2}), RunOf("a", 2, {8, 2.001}), RunOf("a", 3, {8, 3, 2.5}),
                FailedRun("a", 4), FailedRun("a", 5)});
  const std::vector<MethodSummary> summaries = SummariesOf(runs);
  ASSERT_EQ(summaries.size(), 1);
  const MethodSummary& a = summaries[0];
  EXPECT_EQ(a.runs, 5);
  EXPECT_EQ(a.failed, 2);
  EXPECT_EQ(a.as_good.count, 2);
  EXPECT_EQ(a.as_good.of, 5);
  EXPECT_EQ(a.median, 0.25);
  EXPECT_TRUE(std::isinf(a.highest));
  EXPECT_TRUE(std::isinf(a.seconds_to_as_good));
  // 2 + 2 + 3 seconds for two runs that solve it.
  EXPECT_EQ(a.expected_seconds, 3.5);
  EXPECT_EQ(a.all_iterations, 4);
}

TEST(Study, IntervalOfAShareIsWilsons) {
  // Newcombe 1998, table I: 81 of 263 and 0 of 20.
  const Share share{.count = 81, .of = 263};
  EXPECT_NEAR(share.low(), 0.2553, 1e-4);
  EXPECT_NEAR(share.high(), 0.3662, 1e-4);
  const Share none{.count = 0, .of = 20};
  EXPECT_NEAR(none.low(), 0, 1e-15);
  EXPECT_NEAR(none.high(), 0.1611, 1e-4);
}

TEST(Study, LobesAreComparedWithTheLowestRunAndWithTheMethodsOwn) {
  const std::vector<StudyRun> runs =
      Compared({RunOf("a", 1, {8, 2}, 1), RunOf("a", 2, {8, 2.5}, 1), RunOf("b", 1, {8, 3}, 2),
                RunOf("b", 2, {8, 3.5}, 2), FailedRun("b", 3)});
  const std::vector<MethodSummary> summaries = SummariesOf(runs);
  // A run is not compared with itself.
  EXPECT_EQ(summaries[0].same_lobes.count, 1);
  EXPECT_EQ(summaries[0].same_lobes.of, 1);
  EXPECT_EQ(summaries[0].same_again.count, 1);
  EXPECT_EQ(summaries[1].same_lobes.count, 0);
  EXPECT_EQ(summaries[1].same_lobes.of, 2);
  EXPECT_EQ(summaries[1].same_again.count, 1);
  EXPECT_EQ(summaries[1].same_again.of, 1);
  ASSERT_TRUE(summaries[1].agreement);
  EXPECT_LT(*summaries[1].agreement, kSameLobes);
}

TEST(Study, VerdictSaysWhoWonAndWhoRaisedE) {
  const std::vector<StudyRun> runs = Compared({RunOf("a", 1, {8, 2}), RunOf("a", 2, {8, 2}),
                                               RunOf("b", 1, {8, 4, 5, 3}), FailedRun("b", 2)});
  EXPECT_THAT(VerdictOn(runs),
              ElementsAre("The lowest E, 2, is of a, start 1.",
                          "Runs within 1 % of the lowest E: a all 2 and b none of 2.",
                          "They get there, in the median: a after 1 s.",
                          "E never rose in 2 iterations of a. b raised E in 1 of 3 iterations, by "
                          "25 % at most.",
                          "Other runs with the lobes of the lowest run: a all 1 and b all 1.",
                          "Other runs with the lobes of their own method's lowest run: a all 1.",
                          "Failed, and counted as infinite: b 1 of 2."));
}

TEST(Study, VerdictOnSeveralProblemsAddsThemUp) {
  std::vector<StudyRun> runs = {RunOf("a", 1, {8, 2}), RunOf("a", 2, {8, 2})};
  runs.push_back(RunOf("a", 1, {8, 3}));
  runs.push_back(RunOf("a", 2, {8, 4}));
  runs[2].problem = runs[3].problem = "felt";
  CompareRuns(&runs);
  EXPECT_THAT(VerdictOn(runs), Contains("Runs within 1 % of the lowest E of its problem: a 3 of "
                                        "4."));
}

TEST(Study, VerdictOnNothingButFailuresSaysSo) {
  const std::vector<StudyRun> runs = Compared({FailedRun("a", 1)});
  EXPECT_THAT(VerdictOn(runs), ElementsAre("No run has a result: no such file"));
  EXPECT_TRUE(VerdictOn({}).empty());
}

TEST(Study, LobesOfNoLobesAreNotCompared) {
  std::vector<StudyRun> runs = {RunOf("a", 1, {8, 2}), RunOf("a", 2, {8, 3})};
  for (StudyRun& run : runs) run.file.model = FactorModel(ModelSpec::SharedFactors(0, kGrid));
  CompareRuns(&runs);
  EXPECT_FALSE(runs[1].lobes);
}

TEST(Study, TablesHaveARowEachAndQuoteNames) {
  std::vector<StudyRun> runs = {RunOf("a,b", 1, {8, 2}), FailedRun("c", 1)};
  CompareRuns(&runs);
  const std::string csv = RunsCsv(runs);
  EXPECT_THAT(csv, HasSubstr("\ncopper,\"a,b\",1,2,0,1,"));
  EXPECT_THAT(csv, HasSubstr("\ncopper,c,1,inf,inf,"));
  EXPECT_THAT(csv, HasSubstr(",no such file\n"));
  EXPECT_THAT(TracesCsv(runs), HasSubstr("\ncopper,\"a,b\",1,1,1,2\n"));
  EXPECT_THAT(MethodsCsv(SummariesOf(runs)), HasSubstr("\ncopper,c,1,1,inf,inf,inf,0,"));
}

TEST(Study, FiguresAreWholeFilesOfVectors) {
  if (!HaveGnuplot()) GTEST_SKIP() << "needs gnuplot";
  const TemporaryFolder folder;
  std::vector<StudyRun> runs = {RunOf("a 'quoted' %", 1, {8, 2}), RunOf("b", 1, {8, 0}),
                                FailedRun("c", 1)};
  CompareRuns(&runs);
  for (const StudyFigure& figure : StudyFigures()) {
    ASSERT_TRUE(DrawStudyFigure(figure, runs, folder / ".")) << figure.name;
    const std::string svg = Contents(folder / (std::string(figure.name) + ".svg"));
    EXPECT_THAT(svg, HasSubstr("</svg>"));
    EXPECT_TRUE(Contents(folder / (std::string(figure.name) + ".pdf")).starts_with("%PDF"));
    EXPECT_FALSE(DrawStudyFigure(figure, std::vector{FailedRun("c", 1)}, folder / "."));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
