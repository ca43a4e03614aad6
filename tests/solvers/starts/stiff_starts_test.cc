#include "solvers/starts/stiff_starts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 24, .theta_d = 24, .phi_d = 96};

bool Never() { return false; }

Objective Copper(const ModelSpec& spec) {
  return MakeObjective(Synthesize(FindSynthMaterial("copper"), 0, 1, kGrid), spec, "appearance");
}

TEST(CoarseObjective, HasTablesOfHalfTheEntries) {
  const Objective objective = Copper(ModelSpec::SharedFactors(2, kGrid));
  const std::optional<Objective> coarse = CoarseObjective(objective);
  ASSERT_TRUE(coarse);
  for (const Factor factor : kFactors) {
    EXPECT_EQ(2 * coarse->spec().table_size(factor), objective.spec().table_size(factor));
  }
  EXPECT_EQ(coarse->weighting().name, "appearance");
  EXPECT_LT(4 * coarse->samples().size(), objective.samples().size());
}

TEST(CoarseObjective, IsNotOfWhatCannotBeHalved) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  ModelSpec odd = spec;
  odd.g_axis.size = 9;
  EXPECT_FALSE(CoarseObjective(Copper(odd)));
  const BrdfSamples samples = Copper(spec).samples();
  EXPECT_FALSE(CoarseObjective(Objective(Scattered(samples), spec, FindWeighting("appearance"))));
  ModelSpec stretched = spec;
  stretched.stretches = Stretch{.along = 1};
  EXPECT_FALSE(CoarseObjective(Objective(samples, stretched, FindWeighting("appearance"))));
}

TEST(SoftenCoarseStarts, RanksStartsAndPutsThoseThatAreAlikeLast) {
  const Objective objective = Copper(ModelSpec::SharedFactors(2, kGrid));
  const Objective coarse = CoarseObjective(objective).value();
  PhaseSeconds phases;
  const std::vector<CoarseStart> starts = SoftenCoarseStarts(coarse, 1, Never, &phases);
  ASSERT_EQ(starts.size(), 4U);
  std::set<std::string> names;
  double lowest = starts.front().E;
  for (const CoarseStart& start : starts) {
    names.insert(start.name);
    EXPECT_EQ(start.E, coarse.Value(start.model));
    EXPECT_GE(start.E, lowest);
  }
  EXPECT_EQ(names.size(), 4U);
  EXPECT_LT(lowest, 0.1 * coarse.MeasuredEnergy());
  // First the different ones, each higher than the one before; each of the rest like one of these.
  size_t different = 1;
  while (different < starts.size() && starts[different].E > 1.003 * starts[different - 1].E) {
    ++different;
  }
  for (size_t k = different; k < starts.size(); ++k) {
    EXPECT_TRUE(std::any_of(starts.begin(), starts.begin() + static_cast<int>(different),
                            [&](const CoarseStart& other) {
                              return other.E <= starts[k].E && starts[k].E <= 1.003 * other.E;
                            }))
        << starts[k].name;
  }
  const std::vector<CoarseStart> by_two = SoftenCoarseStarts(coarse, 2, Never, &phases);
  ASSERT_EQ(by_two.size(), starts.size());
  for (size_t k = 0; k < starts.size(); ++k) {
    EXPECT_STREQ(by_two[k].name, starts[k].name);
    EXPECT_TRUE(std::ranges::equal(by_two[k].model.parameters(), starts[k].model.parameters()));
  }
}

// A model of the coarse samples is worth a few steps on finer ones.
TEST(SoftenFurther, GoesOnFromTheCoarseModel) {
  const Objective objective = Copper(ModelSpec::SharedFactors(2, kGrid));
  PhaseSeconds phases;
  const std::vector<CoarseStart> starts =
      SoftenCoarseStarts(CoarseObjective(objective).value(), 1, Never, &phases);
  ASSERT_FALSE(starts.empty());
  const FactorModel given = RandomModel(objective.spec(), 1);
  const FactorModel model = SoftenFurther(starts.front(), objective, given, Never, &phases);
  EXPECT_EQ(model.spec(), objective.spec());
  EXPECT_LT(objective.Value(model), 0.02 * objective.MeasuredEnergy());
  for (size_t k = 0; k < objective.coverage().size(); ++k) {
    if (objective.coverage()[k] > 0) continue;
    EXPECT_EQ(model.parameters()[k], given.parameters()[k]) << k;
  }
}

TEST(SoftenCoarseStarts, MakesNoneOnceItIsToStop) {
  const Objective coarse = CoarseObjective(Copper(ModelSpec::SharedFactors(1, kGrid))).value();
  PhaseSeconds phases;
  EXPECT_TRUE(SoftenCoarseStarts(
                  coarse, 2, [] { return true; }, &phases)
                  .empty());
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
