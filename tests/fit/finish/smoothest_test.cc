#include "fit/finish/smoothest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/joint/log_stepper.h"
#include "tests/test_util.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 20, .theta_d = 20, .phi_d = 40};

const StopCheck kGoOn = [] { return false; };
const auto kAny = [](const FactorModel& /*model*/) { return true; };

struct Fitted {
  Objective objective;
  FactorModel model;
};

// A noisy material, at the least E near by, with zeros in its tables.
Fitted FittedModel() {
  Objective objective = MakeObjective(Synthesize(FindSynthMaterial("plastic"), 0.2, 1, kGrid),
                                      ModelSpec::SharedFactors(3, kGrid), "appearance");
  FactorModel model = InitialModels().front().make(objective, 1);
  MakeSolver("varpro")->Solve(objective, {.diagnose = false}, &model);
  return {std::move(objective), std::move(model)};
}

double RoughnessOf(const Objective& objective, const FactorModel& model) {
  std::vector<double> y;
  for (const double x : model.parameters()) y.push_back(std::log(std::max(x, 1e-12)));
  return Roughness(objective.spec(), objective.coverage(), 0.1)(y);
}

TEST(Smoothest, IsAsSmoothAsTheShareAllows) {
  const Fitted fitted = FittedModel();
  const double E = fitted.objective.Value(fitted.model);
  EXPECT_GT(std::ranges::count(fitted.model.parameters(), 0.0), 3);
  double before = RoughnessOf(fitted.objective, fitted.model);
  for (const double share : {0.0005, 0.002}) {
    const std::optional<SmoothedModel> smooth =
        Smoothest(fitted.objective, fitted.model, share, kAny, kGoOn);
    ASSERT_TRUE(smooth);
    EXPECT_NEAR(fitted.objective.Value(smooth->model) / E - 1, smooth->rise, 1e-12);
    EXPECT_LE(smooth->rise, share);
    EXPECT_GE(smooth->rise, 0.3 * share);
    EXPECT_GT(smooth->stiffness, 0);
    EXPECT_EQ(std::ranges::count(smooth->model.parameters(), 0.0), 0) << "holes are filled";
    const double roughness = RoughnessOf(fitted.objective, smooth->model);
    EXPECT_LT(roughness, before / 2);
    before = roughness;
  }
}

// The smoothest first, until one is.
TEST(Smoothest, IsWhatIsAcceptable) {
  const Fitted fitted = FittedModel();
  std::vector<double> asked;
  const auto the_second = [&](const FactorModel& model) {
    asked.push_back(RoughnessOf(fitted.objective, model));
    return asked.size() == 2;
  };
  const auto smooth = Smoothest(fitted.objective, fitted.model, 0.02, the_second, kGoOn);
  ASSERT_TRUE(smooth);
  ASSERT_EQ(asked.size(), 2);
  EXPECT_LT(asked[0], asked[1]);
  EXPECT_EQ(RoughnessOf(fitted.objective, smooth->model), asked[1]);
  const auto none = [](const FactorModel& /*model*/) { return false; };
  EXPECT_FALSE(Smoothest(fitted.objective, fitted.model, 0.02, none, kGoOn));
}

TEST(Smoothest, HasNothingToDoWithoutAnError) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const Objective black = MakeObjective(TableOf(FactorModel(spec), kGrid), spec);
  EXPECT_FALSE(Smoothest(black, FactorModel(spec), 0.005, kAny, kGoOn));
}

TEST(Smoothest, StopsWhenAsked) {
  const Fitted fitted = FittedModel();
  EXPECT_FALSE(Smoothest(fitted.objective, fitted.model, 0.005, kAny, [] { return true; }));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
