#include "trilobe/solvers/race/stretch_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/test_util.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/solvers/initial_model.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

constexpr MerlGrid kGrid{.theta_h = 20, .theta_d = 15, .phi_d = 30};

// A glossy lobe over a diffuse term, with highlights that widen by this.
FactorModel Glossy(const Stretch& stretch) {
  ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  spec.stretch = stretch;
  FactorModel model(spec);
  std::ranges::fill(model.d(), 0.05);
  std::ranges::fill(model.s(0), 1.0);
  for (int k = 0; k < spec.d_axis.size; ++k) {
    model.table(Factor::kD, 0)[k] = 3 * std::exp(-std::pow((k + 0.5) / 7, 2)) + 1e-3;
  }
  for (int c = 0; c < kChannels; ++c) {
    for (int k = 0; k < spec.f_axis.size; ++k) {
      model.table(Factor::kF, c)[k] = 0.2 + 0.1 * c + std::pow((k + 0.5) / spec.f_axis.size, 4);
    }
  }
  for (int k = 0; k < spec.g_axis.size; ++k) {
    model.table(Factor::kG, 0)[k] = std::cos((k + 0.5) / spec.g_axis.size * 1.4);
  }
  return model;
}

FactorModel Fitted(const Objective& objective) {
  FactorModel model = InitialModels().front().make(objective, 1);
  MakeSolver("varpro")->Solve(objective, {.max_iterations = 20, .diagnose = false}, &model);
  return model;
}

TEST(FitStretch, FindsTheOneThatTheDataHave) {
  for (const Stretch& truth :
       {Stretch{.along = -0.3, .across = 0.4}, {.along = 0.5, .across = 0}}) {
    const Objective objective = MakeObjective(TableOf(Glossy(truth), kGrid),
                                              ModelSpec::SharedFactors(1, kGrid), "appearance");
    const FactorModel fitted = Fitted(objective);
    const FactorModel found = FitStretch(objective, fitted, [] { return false; });
    EXPECT_NEAR(found.spec().stretch.along, truth.along, 0.051);
    EXPECT_NEAR(found.spec().stretch.across, truth.across, 0.051);
    EXPECT_LT(Objective(objective, found.spec()).Value(found), 0.05 * objective.Value(fitted));
  }
}

TEST(FitStretch, IsTheSameForAnyNumberOfThreads) {
  const auto found = [](int threads) {
    const Objective objective =
        MakeObjective(TableOf(Glossy({.along = 0.2, .across = -0.2}), kGrid),
                      ModelSpec::SharedFactors(1, kGrid), "appearance", threads);
    return FitStretch(objective, Glossy({}), [] { return false; });
  };
  const FactorModel one = found(1), three = found(3);
  EXPECT_EQ(one.spec(), three.spec());
  EXPECT_TRUE(std::ranges::equal(one.parameters(), three.parameters()));
}

TEST(FitStretch, StoppedItLeavesWhatItHas) {
  const Objective objective = MakeObjective(TableOf(Glossy({.along = 0.2, .across = 0.4}), kGrid),
                                            ModelSpec::SharedFactors(1, kGrid), "appearance");
  const FactorModel start = Glossy({});
  const FactorModel found = FitStretch(objective, start, [] { return true; });
  EXPECT_FALSE(found.spec().stretch.any());
  EXPECT_TRUE(std::ranges::equal(found.parameters(), start.parameters()));
}

}  // namespace
}  // namespace trilobe
