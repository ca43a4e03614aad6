#include "solvers/starts/start_elimination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "solvers/sweep.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kFine{.theta_h = 24, .theta_d = 24, .phi_d = 96};
constexpr StartElimination::Thinning kThinning{.samples_per_parameter = 25, .max_stride = 24};

bool Never() { return false; }

// Starts that begin, and go on, only while there is time.
TEST(StartElimination, MakesNoStartOnceTimeIsUp) {
  constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(2, kGrid), "compressive", 2);
  bool stop = false;
  StartElimination elimination(objective, kThinning, [&] { return stop; });
  elimination.Enter("first", [&](PhaseSeconds*) { return RandomModel(objective.spec(), 1); });
  EXPECT_EQ(elimination.leader(), nullptr);
  elimination.Advance(3);
  ASSERT_NE(elimination.leader(), nullptr);
  const double E = elimination.thinned().Value(*elimination.leader());
  stop = true;
  int made = 0;
  elimination.Enter("second", [&](PhaseSeconds*) {
    ++made;
    return RandomModel(objective.spec(), 2);
  });
  elimination.Advance(100);
  elimination.Keep(1);
  EXPECT_EQ(made, 0);
  EXPECT_EQ(elimination.thinned().Value(*elimination.leader()), E);
  ASSERT_EQ(elimination.Results().size(), 1U);
  EXPECT_EQ(elimination.Results().front().name, "first");
}

// E of all samples is estimated from every stride-th: the same data twice as fine in phi_d.
TEST(StartElimination, RanksByAFewOfManySamples) {
  const ModelSpec spec = ModelSpec::SharedFactors(0, kFine);
  const Objective objective = MakeObjective(RandomTable(kFine, 1, 0.2, 0.3), spec);
  StartElimination elimination(objective, kThinning, Never);
  EXPECT_LT(elimination.thinned().samples().size(), objective.samples().size() / 20);
  const FactorModel start = RandomModel(spec, 1);
  elimination.Enter("start", [&](PhaseSeconds*) -> std::optional<FactorModel> { return start; });
  elimination.Advance(20);
  // Noise of 0.3 in thousands of samples: the two means of E differ by some 5 %.
  EXPECT_NEAR(elimination.Results().front().objective, objective.Value(*elimination.leader()),
              0.05 * objective.Value(*elimination.leader()));
}

TEST(StartElimination, ThinsNoMoreThanAskedFor) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kFine);
  const Objective objective = MakeObjective(RandomTable(kFine, 1), spec);
  const int all = objective.samples().size(), parameters = spec.num_parameters();
  for (const int per_number : {10, 25, 100}) {
    const StartElimination elimination(
        objective, {.samples_per_parameter = per_number, .max_stride = 1000}, Never);
    EXPECT_GE(1.1 * elimination.thinned().samples().size(),
              std::min(all, 2 * per_number * parameters));
    EXPECT_LE(elimination.thinned().samples().size(),
              std::max(0.7 * all, 4.4 * per_number * parameters));
  }
  const StartElimination elimination(objective, {.samples_per_parameter = 1, .max_stride = 1},
                                     Never);
  EXPECT_EQ(elimination.thinned().samples().size(), all);
}

// Thinning is lessened until all samples are there; starts go on from where they are, with new E.
TEST(StartElimination, ThinsLess) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kFine);
  const Objective objective = MakeObjective(RandomTable(kFine, 1), spec);
  const int all = objective.samples().size();
  StartElimination elimination(objective, {.samples_per_parameter = 1, .max_stride = 8}, Never);
  elimination.Enter(
      "start", [&](PhaseSeconds*) -> std::optional<FactorModel> { return RandomModel(spec, 1); });
  elimination.Advance(1);
  int tries = 1;
  for (const int stride : {4, 2, 1}) {
    const FactorModel before = *elimination.leader();
    elimination.ThinLess();
    EXPECT_NEAR(elimination.thinned().samples().size(), 1.0 * all / stride, 0.02 * all);
    EXPECT_TRUE(std::ranges::equal(elimination.leader()->parameters(), before.parameters()));
    EXPECT_EQ(elimination.Results().front().objective,
              elimination.thinned().Value(before) *
                  (objective.MeasuredEnergy() / elimination.thinned().MeasuredEnergy()));
    elimination.Advance(tries += 3);
    EXPECT_LT(elimination.thinned().Value(*elimination.leader()),
              elimination.thinned().Value(before));
  }
  elimination.ThinLess();
  EXPECT_EQ(elimination.thinned().samples().size(), all);
}

TEST(StartElimination, SweepsAsAwlsDoes) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kFine);
  const Objective objective = MakeObjective(RandomTable(kFine, 1), spec);
  StartElimination elimination(objective, kThinning, Never);
  const FactorModel start = RandomModel(spec, 1);
  elimination.Enter("swept", [&](PhaseSeconds*) -> std::optional<FactorModel> { return start; },
                    {.count = 7, .in_blocks = false});
  elimination.Advance(0);
  FactorModel swept = start;
  PhaseSeconds phases;
  GridSweep sweep(elimination.thinned(), &phases);
  for (int k = 0; k < 7; ++k) sweep(nullptr, &swept);
  ASSERT_NE(elimination.leader(), nullptr);
  EXPECT_TRUE(std::ranges::equal(elimination.leader()->parameters(), swept.parameters()));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
