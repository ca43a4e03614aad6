#include "trilobe/solvers/solver.h"

#include <glog/logging.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/error_of.h"
#include "tests/solvers/solver_kinds.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(Solver, KnowsItsNames) {
  std::vector<std::string> names;
  for (const SolverEntry& entry : kLibrarySolvers) {
    names.push_back(entry.name);
    EXPECT_FALSE(entry.description.empty());
    EXPECT_NE(entry.make(), nullptr);
    EXPECT_NE(MakeSolver(entry.name), nullptr);
  }
  EXPECT_EQ(names.front(), "auto");
  EXPECT_THAT(names, testing::IsSupersetOf({"awls_literal", "lm_plain"}));
}

TEST(Solver, UnknownNamesListTheKnownOnes) {
  EXPECT_THAT(ErrorOf([] { MakeSolver("simplex"); }),
              IsError(ErrorKind::kUnknown, {.key = "solver", .value = "simplex"}));
}

TEST(Solver, NamesWhyItStopped) {
  EXPECT_STREQ(StopReasonName(StopReason::kConverged), "converged");
  EXPECT_STREQ(StopReasonName(StopReason::kExactFit), "exact_fit");
  EXPECT_STREQ(StopReasonName(StopReason::kMaxIterations), "max_iterations");
  EXPECT_STREQ(StopReasonName(StopReason::kMaxSeconds), "max_seconds");
  EXPECT_STREQ(StopReasonName(StopReason::kInterrupted), "interrupted");
}

TEST(Solver, ReportsInOneLine) {
  SolverSummary summary;
  summary.solver = "awls";
  summary.iterations = 12;
  summary.initial_objective = 34.5;
  summary.final_objective = 6.25;
  summary.stop_reason = StopReason::kConverged;
  const std::string report = summary.BriefReport();
  for (const char* const part : {"awls", "12", "34.5", "6.25", "converged"}) {
    EXPECT_THAT(report, testing::HasSubstr(part));
  }
  EXPECT_THAT(report, testing::Not(testing::HasSubstr("\n")));
}

TEST(Solver, ReportsInFull) {
  SolverSummary summary;
  summary.solver = "awls";
  summary.own_options = FindSolver("awls").options;
  summary.stop_reason = StopReason::kNoDecrease;
  summary.initial_objective = 34.5;
  summary.final_objective = 6.25;
  summary.iterations = 2;
  summary.seconds = 1.5;
  summary.trace = {{0, 0, 34.5}, {1, 1, 6.25, false, true, 0.5}, {2, 1.5, 6.25, false, false, 0}};
  summary.given.g_filter_sigma = 2;
  summary.given.memory = 77;  // awls does not read it
  summary.notes = {"The filter was switched off."};
  const std::string plain = summary.FullReport();
  for (const char* const part :
       {"solver       awls: 2 iterations, stopped by no_decrease\n",
        "E 34.5 -> 6.25, lowest after iteration 1, 1 steps taken back, last step 0 of |x|\n",
        "max_iterations 100, max_seconds inf, ", "g_filter_sigma 0 (given 2)\n",
        "note         The filter was switched off.\n", "phases       1.5 s solving"}) {
    EXPECT_THAT(plain, testing::HasSubstr(part));
  }
  for (const char* const part : {"diagnosis ", "memory", "reading", "nan"}) {
    EXPECT_THAT(plain, testing::Not(testing::HasSubstr(part)));
  }
  summary.diagnosis = {.gradient = {},
                       .optimality = 0.125,
                       .observed_parameters = 9,
                       .rank = 7,
                       .rank_tolerance = 1e-9,
                       .condition = 1e6};
  summary.phases.reading = 0.25;
  const std::string full = summary.FullReport();
  EXPECT_THAT(full, testing::HasSubstr("optimality 0.125, rank 7 of 9 observed parameters"));
  EXPECT_THAT(full, testing::HasSubstr("phases       0.25 s reading, 1.5 s solving"));
}

// An empty summary, of a solver that is in no list.
TEST(Solver, ReportsWhatIsThere) {
  EXPECT_THAT(SolverSummary().FullReport(), testing::HasSubstr("options      max_iterations 100"));
  EXPECT_EQ(SolverSummary().BestIteration(), 0);
  EXPECT_EQ(SolverSummary().RejectedSteps(), 0);
}

TEST(Solver, LogsIterationsWhereAskedTo) {
  constexpr MerlGrid kGrid{.theta_h = 5, .theta_d = 5, .phi_d = 8};
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  FLAGS_logtostderr = true;
  for (const int level : {0, 1}) {
    FLAGS_v = level;
    FactorModel model = RandomModel(spec, 1);
    testing::internal::CaptureStderr();
    MakeSolver("awls")->Solve(objective, {.max_iterations = 2, .relative_decrease_tolerance = 0},
                              &model);
    const std::string log = testing::internal::GetCapturedStderr();
    for (const char* const line : {"awls 0: E ", "awls 2: E ", "awls ended: max_iterations, E "}) {
      EXPECT_EQ(log.find(line) != std::string::npos, level == 1) << log;
    }
  }
  FLAGS_v = 0;
}

TEST(Solver, AllFitScatteredSamples) {
  constexpr MerlGrid kGrid{.theta_h = 5, .theta_d = 5, .phi_d = 8};
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  BrdfSamples samples = Scattered(ValidSamples(RandomTable(kGrid, 1)));
  for (HalfDiffAngles& angles : samples.angles) angles.theta_h *= 0.9;
  const Objective objective(samples, spec, FindWeighting("uniform"));
  for (const SolverEntry& entry : kLibrarySolvers) {
    const std::string& solver = entry.name;
    if (NeedsAGrid(entry)) {
      FactorModel model = RandomModel(spec, 1);
      const std::vector<double> before(model.parameters().begin(), model.parameters().end());
      EXPECT_THAT(ErrorOf([&] { MakeSolver(solver)->Solve(objective, {}, &model); }),
                  IsError(ErrorKind::kUnsupported, {.key = "solver", .value = "awls_gss"}));
      EXPECT_THAT(model.parameters(), testing::ElementsAreArray(before));
      continue;
    }
    FactorModel model = RandomModel(spec, 1);
    SolverOptions options;
    options.max_iterations = 10;
    options.relative_decrease_tolerance = 0;
    options.optimality_tolerance = 0;
    const SolverSummary summary = MakeSolver(solver)->Solve(objective, options, &model);
    EXPECT_GE(summary.iterations, 5) << solver;
    for (size_t k = 1; k < summary.trace.size(); ++k) {
      EXPECT_LE(summary.trace[k].objective, summary.trace[k - 1].objective) << solver;
    }
    EXPECT_LT(summary.final_objective, 0.9 * summary.initial_objective) << solver;
    EXPECT_EQ(objective.Value(model), summary.final_objective) << solver;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
