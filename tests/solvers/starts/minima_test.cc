// Groups of starts that have ended in the same minimum, and conclusions on further minima.
#include "solvers/starts/minima.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "model/objective/lobes.h"
#include "solvers/starts/start_elimination.h"
#include "tests/test_util.h"
#include "trilobe/solvers/solver.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Random starts that have ended in these minima.
Minima Ended(const std::vector<int>& minima) {
  Minima result;
  for (const int minimum : minima) {
    result.starts.push_back({.name = "roughness/" + std::to_string(result.starts.size()),
                             .objective = 1.0 * minimum,
                             .minimum = minimum});
  }
  return result;
}

TEST(Minima, ExpectNewOnesAsBoenderAndRinnooyKanDo) {
  EXPECT_EQ(Ended({1}).NewMinimum(), 1);                              // one tells nothing
  EXPECT_EQ(Ended({1, 2, 3, 4}).NewMinimum(), 1);                     // each its own
  EXPECT_NEAR(Ended({1, 1, 1, 1, 1}).NewMinimum(), 2.0 / 20, 1e-15);  // w = 1, n = 5
  EXPECT_NEAR(Ended({1, 1, 2, 2, 2, 3}).NewMinimum(), 12.0 / 30, 1e-15);
}

TEST(Minima, AreEnoughWhereThreeAgreeAndFewAreUnseen) {
  EXPECT_FALSE(Ended(std::vector<int>(6, 1)).Enough());  // 2 / 30
  EXPECT_TRUE(Ended(std::vector<int>(7, 1)).Enough());   // 2 / 42
  std::vector<int> rare(40, 2);
  rare[0] = rare[1] = 1;
  EXPECT_LT(Ended(rare).NewMinimum(), 0.01);
  EXPECT_FALSE(Ended(rare).Enough());  // two in the lowest
  rare[2] = 1;
  EXPECT_TRUE(Ended(rare).Enough());
}

// On red-fabric all that are not random agree 14 % above the lowest.
TEST(Minima, StartsThatAreNotRandomSayNothingOfOthers) {
  Minima minima = Ended(std::vector<int>(9, 1));
  for (StartResult& start : minima.starts) start.name = "wide";
  EXPECT_EQ(minima.NewMinimum(), 1);
  EXPECT_FALSE(minima.Enough());
  EXPECT_EQ(minima.Describe(), "of 9 starts, 0 of them random, 9 ended in the lowest of 1 minimum");
}

TEST(Minima, AreDescribedInOneSentence) {
  EXPECT_EQ(
      Ended({1, 1, 2, 2, 2, 3}).Describe(),
      "of 6 starts, 6 of them random, 2 ended in the lowest of 3 minima; a further random one "
      "would be expected to end in a new minimum with a probability of 40 %");
}

// All these models have nearly the same E, as the data are far brighter than any.
TEST(FindMinima, TellsApartByLobesWhatHasTheSameE) {
  constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1, 0, 0.1), spec, "uniform");
  FactorModel model = RandomModel(spec, 3, 2);
  for (int lobe = 0; lobe < 2; ++lobe) {
    for (double& s : model.s(lobe)) s *= lobe == 0 ? 1e-9 : 1e-12;  // the first has the light
  }
  FactorModel other = model;  // whose first lobe has a narrow D
  const std::span<double> D = other.table(Factor::kD, 0);
  for (double& x : D.subspan(1)) x *= 1e-9;
  FactorModel far = model;
  for (double& d : far.d()) d = 1e3;
  StartElimination elimination(objective, StartElimination::kThinned, nullptr);
  const auto enter = [&](const char* name, const FactorModel& start) {
    elimination.Enter(name, [start](PhaseSeconds*) { return start; }, {.count = 0});
  };
  enter("a", model);
  enter("turned/1", WithLobes(model, std::vector<int>{1, 0}));  // the same lobes
  enter("other", other);
  enter("far", far);
  elimination.Advance(0);
  const Minima minima = FindMinima(elimination, objective);
  ASSERT_EQ(minima.starts.size(), 4U);
  std::vector<std::pair<std::string, int>> found;
  for (const StartResult& start : minima.starts) found.emplace_back(start.name, start.minimum);
  ASSERT_NEAR(minima.starts[2].objective / minima.starts[0].objective, 1, 1e-4);
  const auto of = [&](const std::string& name) {
    return std::ranges::find(found, name, &std::pair<std::string, int>::first)->second;
  };
  EXPECT_EQ(of("a"), of("turned/1"));
  EXPECT_NE(of("a"), of("other"));
  EXPECT_EQ(of("far"), 3);
  EXPECT_EQ(minima.count(), 3);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
