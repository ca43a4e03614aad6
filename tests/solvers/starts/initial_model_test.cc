#include "trilobe/solvers/starts/initial_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};

struct NamedTable {
  std::string name;
  BrdfTable table;
};

std::vector<NamedTable> OddTables() {
  const BrdfTable random = RandomTable(kGrid, 1);
  const auto scaled = [&](double by) {
    BrdfTable table = random;
    for (auto& plane : table.stored) {
      for (double& x : plane) x *= by;
    }
    return table;
  };
  BrdfTable black = random, no_red = random, spike = random;
  for (auto& plane : black.stored) {
    std::ranges::replace_if(
        plane, [](double x) { return x > 0; }, 0);
  }
  std::ranges::replace_if(
      no_red.stored[0], [](double x) { return x > 0; }, 0);
  BrdfTable single = MakeInvalidTable("single", kGrid), black_single = single;
  const int bin = kGrid.Index(2, 3, 4);
  for (int c = 0; c < kChannels; ++c) {
    spike.SetValue(c, bin, 1e6);
    single.SetValue(c, bin, 0.5);
    black_single.SetValue(c, bin, 0);
  }
  return {{"random", random},        {"tiny", scaled(1e-12)},
          {"huge", scaled(1e12)},    {"smallest", scaled(1e-48)},
          {"largest", scaled(1e46)}, {"black", black},
          {"no red", no_red},        {"spike", spike},
          {"single", single},        {"black single", black_single}};
}

TEST(InitialModel, IsFiniteAndNotNegativeForAnyDataAndSpec) {
  std::vector<NamedSpec> specs = TestSpecs(kGrid);
  specs.push_back({"8 lobes", ModelSpec::SharedFactors(kMaxLobes, kGrid)});
  const std::vector<NamedTable> tables = OddTables();
  for (const NamedTable& data : tables) {
    for (const NamedSpec& named : specs) {
      const ModelSpec& spec = named.spec;
      for (const Weighting& weighting : Weightings()) {
        if (!IsOneIn(7, {NumberOf(data, tables), NumberOf(named, specs),
                         NumberOf(weighting, Weightings())})) {
          continue;
        }
        const Objective objective = MakeObjective(data.table, spec, weighting.name);
        for (const InitialModel& init : InitialModels()) {
          const std::string what =
              data.name + ", " + named.name + ", " + weighting.name + ", " + init.name;
          const FactorModel model = init.make(objective, 7);
          EXPECT_EQ(model.spec(), spec) << what;
          ASSERT_TRUE(std::ranges::all_of(model.parameters(), [](double x) {
            return std::isfinite(x) && x >= 0;
          })) << what;
          ASSERT_TRUE(std::isfinite(objective.Value(model))) << what;
          const FactorModel again = init.make(objective, 7);
          ASSERT_TRUE(std::ranges::equal(again.parameters(), model.parameters())) << what;
        }
      }
    }
  }
}

// On a measurement with a highlight every lobe is alive, or AWLS would have nothing to move.
TEST(InitialModel, EveryLobeLives) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const Objective objective = MakeObjective(RandomTable(kGrid, 2), spec);
    for (const InitialModel& init : InitialModels()) {
      const FactorModel model = init.make(objective, 1);
      EXPECT_TRUE(std::ranges::all_of(model.parameters(), [](double x) { return x > 0; }))
          << name << ", " << init.name;
      EXPECT_LT(objective.Value(model), 100 * objective.MeasuredEnergy())
          << name << ", " << init.name;
    }
  }
}

TEST(InitialModel, WorksOnScatteredSamples) {
  const ModelSpec spec = ModelSpec::SharedFactors(3, kGrid);
  const Objective objective(Scattered(ValidSamples(RandomTable(kGrid, 3))), spec,
                            FindWeighting("compressive"));
  for (const InitialModel& init : InitialModels()) {
    const FactorModel model = init.make(objective, 1);
    EXPECT_TRUE(std::ranges::all_of(model.parameters(), [](double x) {
      return std::isfinite(x) && x > 0;
    })) << init.name;
  }
}

TEST(InitialModel, OnlyTheRandomOnesDependOnTheSeed) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 4), ModelSpec::SharedFactors(3, kGrid));
  for (const InitialModel& init : InitialModels()) {
    const FactorModel one = init.make(objective, 1), two = init.make(objective, 2);
    const bool random = init.name == "random" || init.name == "roughness";
    EXPECT_EQ(std::ranges::equal(one.parameters(), two.parameters()), !random) << init.name;
  }
}

TEST(InitialModel, ByName) {
  for (const InitialModel& init : InitialModels()) {
    EXPECT_EQ(&FindInitialModel(init.name), &init);
    EXPECT_FALSE(init.description.empty());
  }
  for (const char* const name : {"constant", "analytic", "highlight", "roughness", "random"}) {
    EXPECT_NO_THROW(FindInitialModel(name));
  }
  EXPECT_THAT(ErrorOf([] { FindInitialModel("psychic"); }),
              IsError(ErrorKind::kUnknown, {.key = "init", .value = "psychic"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
