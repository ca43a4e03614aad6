#include "trilobe/solvers/solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/test_util.h"
#include "trilobe/base/error.h"

namespace trilobe {
namespace {

TEST(Solver, KnowsItsNames) {
  std::vector<std::string> names;
  for (const SolverEntry& entry : Solvers()) {
    names.push_back(entry.name);
    EXPECT_FALSE(entry.description.empty());
    EXPECT_NE(entry.make(), nullptr);
    EXPECT_NE(MakeSolver(entry.name), nullptr);
  }
  EXPECT_EQ(names.front(), "awls");
  EXPECT_THAT(names, testing::IsSupersetOf({"awls_literal", "lm_plain"}));
}

TEST(Solver, UnknownNamesListTheKnownOnes) {
  try {
    MakeSolver("newton");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("unknown solver 'newton'; known: awls, "));
    EXPECT_THAT(error.what(), testing::HasSubstr("awls_literal"));
  }
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

TEST(Solver, AwlsNeedsAGrid) {
  constexpr MerlGrid kGrid{.theta_h = 5, .theta_d = 5, .phi_d = 8};
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const Objective objective(Scattered(ValidSamples(RandomTable(kGrid, 1))), spec,
                            FindWeighting("uniform"));
  FactorModel model = RandomModel(spec, 1);
  const std::vector<double> before(model.parameters().begin(), model.parameters().end());
  try {
    MakeSolver("awls")->Solve(objective, {}, &model);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("awls_literal"));
  }
  EXPECT_THAT(model.parameters(), testing::ElementsAreArray(before));
}

TEST(Solver, SomeFitScatteredSamples) {
  constexpr MerlGrid kGrid{.theta_h = 5, .theta_d = 5, .phi_d = 8};
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  BrdfSamples samples = Scattered(ValidSamples(RandomTable(kGrid, 1)));
  for (HalfDiffAngles& angles : samples.angles) angles.theta_h *= 0.9;
  const Objective objective(samples, spec, FindWeighting("uniform"));
  for (const char* const solver : {"awls_literal", "lm_plain"}) {
    FactorModel model = RandomModel(spec, 1);
    SolverOptions options;
    options.max_iterations = 10;
    options.relative_decrease_tolerance = 0;
    const SolverSummary summary = MakeSolver(solver)->Solve(objective, options, &model);
    EXPECT_EQ(summary.iterations, 10) << solver;
    for (size_t k = 1; k < summary.trace.size(); ++k) {
      EXPECT_LE(summary.trace[k].objective, summary.trace[k - 1].objective) << solver;
    }
    EXPECT_LT(summary.final_objective, 0.9 * summary.initial_objective) << solver;
    EXPECT_EQ(objective.Value(model), summary.final_objective) << solver;
  }
}

}  // namespace
}  // namespace trilobe
