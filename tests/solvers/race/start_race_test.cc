#include "solvers/race/start_race.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "solvers/awls/grid_sweep.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kFine{.theta_h = 24, .theta_d = 24, .phi_d = 96};
constexpr StartRace::Thinning kThinning{.samples_per_parameter = 25, .max_stride = 24};

bool Never() { return false; }

// Entrants that begin, and go on, only while there is time.
TEST(StartRace, MakesNoStartOnceTimeIsUp) {
  constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(2, kGrid), "compressive", 2);
  bool stop = false;
  StartRace race(objective, kThinning, [&] { return stop; });
  race.Enter("first", [&] { return RandomModel(objective.spec(), 1); });
  EXPECT_EQ(race.leader(), nullptr);
  race.Advance(3);
  ASSERT_NE(race.leader(), nullptr);
  const double E = race.thinned().Value(*race.leader());
  stop = true;
  int made = 0;
  race.Enter("second", [&] {
    ++made;
    return RandomModel(objective.spec(), 2);
  });
  race.Advance(100);
  race.Keep(1);
  EXPECT_EQ(made, 0);
  EXPECT_EQ(race.thinned().Value(*race.leader()), E);
  ASSERT_EQ(race.Results().size(), 1U);
  EXPECT_EQ(race.Results().front().name, "first");
}

// E of all samples is estimated from every stride-th: the same data twice as fine in phi_d.
TEST(StartRace, RanksByAFewOfManySamples) {
  const ModelSpec spec = ModelSpec::SharedFactors(0, kFine);
  const Objective objective = MakeObjective(RandomTable(kFine, 1, 0.2, 0.3), spec);
  StartRace race(objective, kThinning, Never);
  EXPECT_LT(race.thinned().samples().size(), objective.samples().size() / 20);
  const FactorModel start = RandomModel(spec, 1);
  race.Enter("start", [&]() -> std::optional<FactorModel> { return start; });
  race.Advance(20);
  // Noise of 0.3 in thousands of samples: the two means of E differ by some 5 %.
  EXPECT_NEAR(race.Results().front().objective, objective.Value(*race.leader()),
              0.05 * objective.Value(*race.leader()));
}

TEST(StartRace, ThinsNoMoreThanAskedFor) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kFine);
  const Objective objective = MakeObjective(RandomTable(kFine, 1), spec);
  const int all = objective.samples().size(), parameters = spec.num_parameters();
  for (const int per_number : {10, 25, 100}) {
    const StartRace race(objective, {.samples_per_parameter = per_number, .max_stride = 1000},
                         Never);
    EXPECT_GE(1.1 * race.thinned().samples().size(), std::min(all, 2 * per_number * parameters));
    EXPECT_LE(race.thinned().samples().size(), std::max(0.7 * all, 4.4 * per_number * parameters));
  }
  const StartRace race(objective, {.samples_per_parameter = 1, .max_stride = 1}, Never);
  EXPECT_EQ(race.thinned().samples().size(), all);
}

// Until all are there; those in the race go on where they are, on the others' terms.
TEST(StartRace, ThinsLess) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kFine);
  const Objective objective = MakeObjective(RandomTable(kFine, 1), spec);
  const int all = objective.samples().size();
  StartRace race(objective, {.samples_per_parameter = 1, .max_stride = 8}, Never);
  race.Enter("start", [&]() -> std::optional<FactorModel> { return RandomModel(spec, 1); });
  race.Advance(1);
  int tries = 1;
  for (const int stride : {4, 2, 1}) {
    const FactorModel before = *race.leader();
    race.ThinLess();
    EXPECT_NEAR(race.thinned().samples().size(), 1.0 * all / stride, 0.02 * all);
    EXPECT_TRUE(std::ranges::equal(race.leader()->parameters(), before.parameters()));
    EXPECT_EQ(race.Results().front().objective,
              race.thinned().Value(before) *
                  (objective.MeasuredEnergy() / race.thinned().MeasuredEnergy()));
    race.Advance(tries += 3);
    EXPECT_LT(race.thinned().Value(*race.leader()), race.thinned().Value(before));
  }
  race.ThinLess();
  EXPECT_EQ(race.thinned().samples().size(), all);
}

TEST(StartRace, SweepsAsAwlsDoes) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kFine);
  const Objective objective = MakeObjective(RandomTable(kFine, 1), spec);
  StartRace race(objective, kThinning, Never);
  const FactorModel start = RandomModel(spec, 1);
  race.Enter("swept", [&]() -> std::optional<FactorModel> { return start; },
             {.count = 7, .in_blocks = false});
  race.Advance(0);
  FactorModel swept = start;
  PhaseSeconds phases;
  GridSweep sweep(race.thinned(), &phases);
  for (int k = 0; k < 7; ++k) sweep(nullptr, &swept);
  ASSERT_NE(race.leader(), nullptr);
  EXPECT_TRUE(std::ranges::equal(race.leader()->parameters(), swept.parameters()));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
