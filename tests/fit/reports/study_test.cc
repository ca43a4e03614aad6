#include "fit/reports/study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "fit/reports/draw_study.h"
#include "fit/reports/profiles.h"
#include "io/pictures/gnuplot.h"
#include "tests/app/run_program.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

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
  EXPECT_EQ(summaries[0].median, 0.125);
  // A run is not compared with itself.
  EXPECT_EQ(summaries[0].same_lobes.count, 1);
  EXPECT_EQ(summaries[0].same_lobes.of, 1);
  EXPECT_EQ(summaries[0].same_as_own.count, 1);
  EXPECT_EQ(summaries[1].same_lobes.count, 0);
  EXPECT_EQ(summaries[1].same_lobes.of, 2);
  EXPECT_EQ(summaries[1].same_as_own.count, 1);
  EXPECT_EQ(summaries[1].same_as_own.of, 1);
  ASSERT_TRUE(summaries[1].agreement);
  EXPECT_LT(*summaries[1].agreement, kSameLobes);
}

TEST(Study, VerdictSaysWhoWonAndWhoRaisedE) {
  const std::vector<StudyRun> runs = Compared({RunOf("a", 1, {8, 2}), RunOf("a", 2, {8, 2}),
                                               RunOf("b", 1, {8, 4, 5, 3}), FailedRun("b", 2)});
  EXPECT_THAT(VerdictOn(runs),
              ElementsAre("The lowest E, 2, is of a, start 1.",
                          "Runs within 1 % of the lowest E: a all 2 and b none of 2.",
                          "They get there, in the median: a after 1 s and b never.",
                          "E never rose in 2 iterations of a. b raised E in 1 of 3 iterations, by "
                          "25 % at most.",
                          "Other runs with the lobes of the lowest run: a all 1 and b all 1.",
                          "Other runs with the lobes of their own method's lowest run: a all 1.",
                          "Each model can be told apart from the measurement.",
                          "Failed, and counted as infinite: b 1 of 2."));
}

TEST(Study, WhatALimitStoppedHasNotFailedToGetThere) {
  std::vector<StudyRun> runs = {RunOf("a", 1, {8, 2}), RunOf("b", 1, {8, 4, 3}),
                                RunOf("b", 2, {8, 5, 4})};
  runs[0].stop_reason = "converged";
  runs[1].stop_reason = runs[2].stop_reason = "max_iterations";
  const std::vector<std::string> verdict = VerdictOn(Compared(runs));
  EXPECT_THAT(verdict, Contains("Not converged, so that E might fall further: b 2 of 2 stopped by "
                                "--max_iterations."));
  EXPECT_THAT(verdict, Contains("They get there, in the median: a after 1 s and b not within the "
                                "limit."));
  const std::vector<MethodSummary> summaries = SummariesOf(Compared(runs));
  EXPECT_EQ(EndingsText(summaries[0]), "1 of 1 converged");
  EXPECT_EQ(EndingsText(summaries[1]), "2 of 2 stopped by --max_iterations");
  EXPECT_FALSE(summaries[0].short_of_limit);
  EXPECT_TRUE(summaries[1].short_of_limit);
  runs[2].stop_reason = "max_seconds";
  EXPECT_THAT(VerdictOn(Compared(runs)),
              Contains("Not converged, so that E might fall further: b 1 of 2 stopped by "
                       "--max_iterations, 1 of 2 stopped by --max_seconds."));
}

TEST(Study, HeldOutSamplesNameTheMethodThatPredictsThem) {
  std::vector<StudyRun> runs = {RunOf("a lobes=1", 1, {8, 3}), RunOf("a lobes=2", 1, {8, 2}),
                                RunOf("a lobes=3", 1, {8, 1.5}), RunOf("a lobes=4", 1, {8, 1})};
  for (size_t k = 0; k < runs.size(); ++k) {
    runs[k].held_out_E = std::vector{0.04, 0.02, 0.0201, 0.03}[k];
  }
  EXPECT_THAT(VerdictOn(Compared(runs)),
              Contains("Samples that were held out are predicted best by a lobes=2, E 2 % of a "
                       "black model's (within 1 % of that: a lobes=3)."));
}

TEST(Study, DifferencesThatAreNotSeenAreCalledSo) {
  std::vector<StudyRun> runs = {RunOf("a", 1, {8, 2}), RunOf("b", 1, {8, 3})};
  for (StudyRun& run : runs) run.seen = false;
  EXPECT_THAT(VerdictOn(Compared(runs)),
              Contains("All 2 models cannot be told apart from the measurement: their differences "
                       "in E are not seen."));
  runs[1].seen = true;
  runs[0].of_sphere = runs[1].of_sphere = false;
  runs[0].mean_delta_e = 0.5;
  runs[1].mean_delta_e = 2.5;
  const std::vector<std::string> verdict = VerdictOn(Compared(runs));
  EXPECT_THAT(verdict,
              Contains("Models that cannot be told apart from the measurement where it was "
                       "measured: a all 1 and b none of 1."));
  EXPECT_THAT(verdict, Contains("Mean Delta E of the samples, in the median: a 0.5 and b 2.5."));
}

TEST(Study, TheLowestEIsHeldAgainstABlackModelAndRepeatedSamples) {
  std::vector<StudyRun> runs = {RunOf("a", 1, {8, 2})};
  runs[0].relative_E = 0.02;
  runs[0].noise_E = 0.005;
  EXPECT_THAT(VerdictOn(Compared(runs)),
              Contains("The lowest E, 2, is of a, start 1: 2 % of a black model's. Noise alone "
                       "would leave 0.5 %, as far as samples of the same directions tell."));
}

TEST(Study, VerdictOnSeveralProblemsAddsThemUp) {
  std::vector<StudyRun> runs = {RunOf("a", 1, {8, 2}), RunOf("a", 2, {8, 2})};
  runs.push_back(RunOf("a", 1, {8, 3}));
  runs.push_back(RunOf("a", 2, {8, 4}));
  runs[2].problem = runs[3].problem = "felt";
  CompareRuns(&runs);
  EXPECT_THAT(VerdictOn(runs), Contains("Runs within 1 % of the lowest E of its problem: a 3 of "
                                        "4."));
  EXPECT_THAT(VerdictOn(runs), Contains("Their median run gets there, in the geometric mean of the "
                                        "problems: a after 1 s on 1 of 2 problems."));
}

TEST(Study, TimesOnSeveralProblemsHaveAGeometricMean) {
  std::vector<StudyRun> runs = {RunOf("a", 1, {8, 2}), RunOf("a", 1, {8, 8, 8, 8, 2}),
                                RunOf("a", 1, {8, 5}), RunOf("b", 1, {8, 2})};
  runs[1].problem = "felt";
  runs[2].problem = runs[3].problem = "foam";
  CompareRuns(&runs);
  const Times times = TimesOf(SummariesOf(runs), "a");
  EXPECT_EQ(times.reached, 2);
  EXPECT_EQ(times.of, 3);
  EXPECT_DOUBLE_EQ(times.geometric_mean, 2);
  EXPECT_THAT(VerdictOn(runs), Contains("Their median run gets there, in the geometric mean of the "
                                        "problems: a after 2 s on 2 of 3 problems and b after 1 "
                                        "s."));
}

// On copper, felt and foam a takes 1, 2 and 4 seconds, and b 2, 1 and forever.
std::vector<StudyRun> RunsOnThreeProblems() {
  std::vector<StudyRun> runs = {RunOf("a", 1, {8, 1}),          RunOf("b", 1, {8, 8, 1}),
                                RunOf("a", 1, {8, 8, 1}),       RunOf("b", 1, {8, 1}),
                                RunOf("a", 1, {8, 8, 8, 8, 1}), RunOf("b", 1, {8, 4})};
  runs[2].problem = runs[3].problem = "felt";
  runs[4].problem = runs[5].problem = "foam";
  return Compared(runs);
}

std::vector<std::pair<double, double>> StepsOf(const Profile& profile) {
  std::vector<std::pair<double, double>> steps;
  for (const Profile::Point& point : profile.points) steps.emplace_back(point.x, point.share);
  return steps;
}

TEST(Study, PerformanceProfilesAreSharesOverTheTimeOfTheFastest) {
  const std::vector<Profile> profiles = PerformanceProfiles(RunsOnThreeProblems());
  ASSERT_EQ(profiles.size(), 2);
  EXPECT_THAT(StepsOf(profiles[0]), ElementsAre(Pair(1, 2.0 / 3), Pair(2, 1)));
  EXPECT_THAT(StepsOf(profiles[1]), ElementsAre(Pair(1, 1.0 / 3), Pair(2, 2.0 / 3)));
  // Wilson's interval of 2 of 3.
  EXPECT_NEAR(profiles[0].points[0].interval.low, 0.2077, 1e-4);
  EXPECT_NEAR(profiles[0].points[0].interval.high, 0.9385, 1e-4);
}

TEST(Study, DataProfilesAreSharesOverSeconds) {
  const std::vector<Profile> profiles = DataProfiles(RunsOnThreeProblems());
  EXPECT_THAT(StepsOf(profiles[0]), ElementsAre(Pair(1, 1.0 / 3), Pair(2, 2.0 / 3), Pair(4, 1)));
  EXPECT_THAT(StepsOf(profiles[1]), ElementsAre(Pair(1, 1.0 / 3), Pair(2, 2.0 / 3)));
}

TEST(Study, ProfilesCountAllStartsOfAProblemAsOneTrial) {
  std::vector<StudyRun> runs = RunsOnThreeProblems();
  for (StudyRun run : RunsOnThreeProblems()) {
    run.start = 2;
    runs.push_back(run);
  }
  const std::vector<Profile> profiles = PerformanceProfiles(runs);
  EXPECT_NEAR(profiles[0].points[0].share, 2.0 / 3, 1e-15);
  EXPECT_NEAR(profiles[0].points[0].interval.low, 0.2077, 1e-4);
}

TEST(Study, ProfilesAreOfThreeProblemsOrMore) {
  const std::vector<StudyRun> three = RunsOnThreeProblems();
  EXPECT_THAT(ProfilesCsv(three), HasSubstr("\nperformance,b,2,0.66666666666666663,"));
  EXPECT_THAT(ProfilesCsv(three), HasSubstr("\ndata,a,4,1,"));
  EXPECT_EQ(ProfilesCsv(std::vector(three.begin(), three.begin() + 4)),
            "profile,method,x,share,low,high\n");
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
  EXPECT_THAT(csv, HasSubstr("\ncopper,\"a,b\",1,2,0,,,1,"));
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
  for (const StudyFigure& figure : ProfileFigures()) {
    EXPECT_FALSE(DrawStudyFigure(figure, runs, folder / "."));  // runs of one problem
    ASSERT_TRUE(DrawStudyFigure(figure, RunsOnThreeProblems(), folder / ".")) << figure.name;
    EXPECT_THAT(Contents(folder / (std::string(figure.name) + ".svg")), HasSubstr("</svg>"));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
