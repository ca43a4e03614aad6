// Directions that a scene does not use need not be fitted; those it uses are fitted no worse.

#include <gtest/gtest.h>

#include "fit/scene/directions.h"
#include "tests/test_util.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 15, .theta_d = 15, .phi_d = 24};

FactorModel Fitted(const Objective& objective) {
  FactorModel model = InitialModels().front().make(objective, 1);
  MakeSolver("auto")->Solve(objective, {.max_iterations = 60, .diagnose = false}, &model);
  return model;
}

TEST(LimitedScene, FitsAsWellThereAsTheFullFit) {
  const DirectionRanges below_60 = {{0, DegreesToRadians(60)}, {0, DegreesToRadians(60)}};
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  for (const char* const name : {"plastic", "felt"}) {
    const BrdfSamples all =
        ValidSamples(Synthesize(FindSynthMaterial(name), /*noise=*/0.05, /*seed=*/1, kGrid));
    const BrdfSamples used = UsedSamples(all, below_60);
    ASSERT_LT(used.size(), 0.6 * all.size());
    const Objective of_all(all, spec, FindWeighting("compressive"));
    const Objective of_used(used, spec, FindWeighting("compressive"));
    const double E_of_full_fit = of_used.Value(Fitted(of_all));
    const double E = of_used.Value(Fitted(of_used));
    // Both fits stop when an iteration gains less than 1e-5.
    EXPECT_LE(E, (1 + 1e-3) * E_of_full_fit) << name;
    EXPECT_GT(E, 0) << name;
  }
}

// Entries that no used direction reads are no parameters.
TEST(LimitedScene, LeavesOutTheEntriesThatNothingReads) {
  const BrdfSamples all = ValidSamples(RandomTable(kGrid, 1));
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const DirectionRanges near_the_normal = {{0, DegreesToRadians(30)}, {0, DegreesToRadians(30)}};
  const Objective objective(UsedSamples(all, near_the_normal), spec, FindWeighting("compressive"));
  const FactorModel layout(spec);
  const auto coverage = [&](Factor factor, int entry) {
    return objective.coverage()[layout.TableOffset(factor, 0) + entry];
  };
  // theta_h and theta_d are at most 30 degrees; a node of G serves to two nodes beyond.
  for (int h = 0; h < kGrid.theta_h; ++h) {
    if (kGrid.Center(h, 0, 0).theta_h > DegreesToRadians(30)) {
      EXPECT_EQ(coverage(Factor::kD, h), 0);
    }
  }
  for (int d = 0; d < kGrid.theta_d; ++d) {
    if (kGrid.Center(0, d, 0).theta_d > DegreesToRadians(30)) {
      EXPECT_EQ(coverage(Factor::kF, d), 0);
    }
  }
  EXPECT_GT(coverage(Factor::kD, 0), 0);
  EXPECT_GT(coverage(Factor::kF, 0), 0);
  EXPECT_EQ(coverage(Factor::kG, spec.g_axis.size - 1), 0);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
