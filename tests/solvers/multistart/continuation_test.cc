// The solver `continuation`: what it promises beyond what every solver does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "solvers/multistart/agreement.h"
#include "solvers/multistart/smooth_starts.h"
#include "tests/test_util.h"
#include "trilobe/model/synth/synth.h"
#include "trilobe/solvers/registry/solvers.h"
#include "trilobe/solvers/solver.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 16, .theta_d = 16, .phi_d = 32};

Objective SynthObjective(const char* material) {
  return MakeObjective(Synthesize(FindSynthMaterial(material), 0.05, 1, kGrid),
                       ModelSpec::SharedFactors(2, kGrid), "appearance");
}

// Two that agree are enough; where no two do, all four have been tried.
TEST(SmoothStarts, EndWhenTwoAgree) {
  for (const char* const material : {"plastic", "aluminium"}) {
    const Objective objective = SynthObjective(material);
    PhaseSeconds phases;
    int pairs = 0;
    const std::vector<SoftenedStart> starts = SoftenStarts(
        objective, RandomModel(objective.spec(), 1), [] { return false; }, &phases,
        [&](const SoftenedStart&) { ++pairs; });
    ASSERT_EQ(starts.size(), 2U * pairs);
    for (const SoftenedStart& start : starts) {
      EXPECT_EQ(start.E, objective.Value(start.model)) << start.name;
      EXPECT_GE(start.E, starts.front().E);
      EXPECT_LT(start.E, 0.05 * objective.MeasuredEnergy()) << material << ", " << start.name;
    }
    std::vector<double> E;
    for (const SoftenedStart& start : starts) E.push_back(start.E);
    EXPECT_EQ(CountAgreeing(E) >= 2, pairs == 1) << material;
  }
}

TEST(Continuation, SaysHowManyStartsAgree) {
  const Objective objective = SynthObjective("plastic");
  FactorModel model = RandomModel(objective.spec(), 1);
  const SolverSummary summary = MakeSolver("continuation")->Solve(objective, {}, &model);
  ASSERT_FALSE(summary.notes.empty());
  EXPECT_THAT(summary.notes.front(), testing::HasSubstr("starts agree"));
  EXPECT_GE(summary.starts.size(), 2U);
  EXPECT_EQ(summary.final_objective, objective.Value(model));
  EXPECT_LE(summary.final_objective, summary.starts.front().objective);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
