#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/test_util.h"
#include "trilobe/solvers/registry/solvers.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/start/initial_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 10};

SolverOptions Iterations(int count) {
  SolverOptions options;
  options.max_iterations = count;
  options.relative_decrease_tolerance = 0;
  return options;
}

TEST(LmPlain, LowersE) {
  const BrdfTable table = RandomTable(kGrid, 1);
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    if (kSanitized && spec.lobes > 2) continue;
    const Objective objective = MakeObjective(table, spec);
    for (const TrustRegion trust_region :
         {TrustRegion::kLevenbergMarquardt, TrustRegion::kDogleg}) {
      FactorModel model = RandomModel(spec, 2);
      SolverOptions options = Iterations(20);
      options.trust_region = trust_region;
      const SolverSummary run = MakeSolver("lm_plain")->Solve(objective, options, &model);
      const std::string what = name + ", " + TrustRegionName(trust_region);
      EXPECT_LT(run.final_objective, 0.7 * run.initial_objective) << what;
      EXPECT_EQ(objective.Value(model), run.final_objective) << what;
      EXPECT_GE(std::ranges::min(model.parameters()), 0) << what;
      EXPECT_GT(run.phases.preparing, 0);
      EXPECT_GT(run.phases.evaluating, 0);
      EXPECT_GT(run.phases.linear_algebra, 0);
    }
  }
}

TEST(LmPlain, SaysHowItKeepsTheBounds) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(1, kGrid));
  for (const Positivity asked : {Positivity::kActiveSet, Positivity::kBounds}) {
    FactorModel model = RandomModel(objective.spec(), 1);
    SolverOptions options = Iterations(1);
    options.positivity = asked;
    const SolverSummary run = MakeSolver("lm_plain")->Solve(objective, options, &model);
    EXPECT_EQ(run.given.positivity, asked);
    const bool has_none = asked == Positivity::kActiveSet;
    EXPECT_EQ(run.used.positivity, has_none ? Positivity::kBounds : asked);
    EXPECT_EQ(run.notes.empty(), !has_none);
  }
}

// A model without a single number above 0 has no derivative but that by d: only d can move.
TEST(LmPlain, LeavesZero) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(2, kGrid));
  FactorModel model(objective.spec());
  const SolverSummary run = MakeSolver("lm_plain")->Solve(objective, Iterations(20), &model);
  EXPECT_LT(run.final_objective, 0.9 * run.initial_objective);
  EXPECT_GT(std::ranges::min(model.d()), 0);
  EXPECT_EQ(std::ranges::max(model.s(0)), 0);
}

// At a stationary point Ceres finds no step, and its reason is passed on.
TEST(LmPlain, EndsWhereNothingCanMove) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(0, kGrid));
  FactorModel model(objective.spec());
  const SolverSummary run = MakeSolver("lm_plain")->Solve(objective, Iterations(1000), &model);
  EXPECT_EQ(run.stop_reason, StopReason::kNoDecrease);
  EXPECT_LT(run.iterations, 100);
  EXPECT_THAT(run.notes, testing::Contains(testing::HasSubstr("Ceres: ")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
