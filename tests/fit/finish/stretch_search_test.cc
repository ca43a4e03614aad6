#include "fit/finish/stretch_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/objective/lobes.h"
#include "tests/test_util.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 20, .theta_d = 15, .phi_d = 30};

// A glossy lobe over a diffuse term, with highlights that widen by this.
FactorModel Glossy(const Stretch& stretch) {
  ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  spec.stretches = stretch;
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

TEST(FitStretches, FindsTheOneThatTheDataHave) {
  for (const Stretch& truth :
       {Stretch{.along = -0.3, .across = 0.4}, {.along = 0.5, .across = 0}}) {
    const Objective objective = MakeObjective(TableOf(Glossy(truth), kGrid),
                                              ModelSpec::SharedFactors(1, kGrid), "appearance");
    const FactorModel fitted = Fitted(objective);
    const FactorModel found = FitStretches(objective, fitted, [] { return false; }).model;
    EXPECT_NEAR(found.spec().stretches.of(0).along, truth.along, 0.051);
    EXPECT_NEAR(found.spec().stretches.of(0).across, truth.across, 0.051);
    EXPECT_LT(Objective(objective, found.spec()).Value(found), 0.05 * objective.Value(fitted));
  }
}

// Two lobes of different widths, each stretched by its own.
TEST(FitStretches, FindsThoseOfTheLobes) {
  ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Stretches truth({{.along = 0.4, .across = 0}, {.along = 0, .across = -0.4}});
  spec.stretches = truth;
  FactorModel model(spec);
  const FactorModel one = Glossy({});
  std::ranges::fill(model.d(), 0.05);
  for (int m = 0; m < 2; ++m) {
    std::ranges::fill(model.s(m), m == 0 ? 1.0 : 0.3);
    for (int k = 0; k < spec.d_axis.size; ++k) {
      model.table(Factor::kD, m)[k] =
          3 * std::exp(-std::pow((k + 0.5) / (m == 0 ? 4 : 10), 2)) + 1e-3;
    }
    std::ranges::copy(one.table(Factor::kG, 0), model.table(Factor::kG, m).begin());
  }
  for (int c = 0; c < kChannels; ++c) {
    std::ranges::copy(one.table(Factor::kF, c), model.table(Factor::kF, c).begin());
  }
  const Objective objective =
      MakeObjective(TableOf(model, kGrid), ModelSpec::SharedFactors(2, kGrid), "appearance");
  const FactorModel start = WithStretches(model, Stretches());
  const FactorModel found = FitStretches(objective, start, [] { return false; }).model;
  for (int m = 0; m < 2; ++m) {
    EXPECT_NEAR(found.spec().stretches.of(m).along, truth.of(m).along, 0.03) << m;
    EXPECT_NEAR(found.spec().stretches.of(m).across, truth.of(m).across, 0.03) << m;
  }
}

TEST(FitStretches, IsTheSameForAnyNumberOfThreads) {
  const auto found = [](int threads) {
    const Objective objective =
        MakeObjective(TableOf(Glossy({.along = 0.2, .across = -0.2}), kGrid),
                      ModelSpec::SharedFactors(1, kGrid), "appearance", threads);
    return FitStretches(objective, Glossy({}), [] { return false; }).model;
  };
  const FactorModel one = found(1), three = found(3);
  EXPECT_EQ(one.spec(), three.spec());
  EXPECT_TRUE(std::ranges::equal(one.parameters(), three.parameters()));
}

// If parameters would follow a step too far, they follow a part of it, or none (last argument).
TEST(StretchStepper, ParametersFollowAsFarAsAsked) {
  const Objective objective = MakeObjective(TableOf(Glossy({.along = 0.2, .across = 0.4}), kGrid),
                                            ModelSpec::SharedFactors(1, kGrid), "appearance");
  const FactorModel start = Glossy({});
  const StretchStepper stepper(objective, start);
  const FactorModel whole = *stepper.Step(1e-2, 0.4), half = *stepper.Step(1e-2, 0.4, 0.5),
                    none = *stepper.Step(1e-2, 0.4, 0);
  EXPECT_TRUE(whole.spec().stretches.any());
  EXPECT_EQ(none.spec(), whole.spec());
  EXPECT_TRUE(std::ranges::equal(none.parameters(), start.parameters()));
  EXPECT_FALSE(std::ranges::equal(whole.parameters(), start.parameters()));
  for (size_t k = 0; k < start.parameters().size(); ++k) {
    if (whole.parameters()[k] == 0) continue;  // at its bound
    const double x = start.parameters()[k], expected = (x + whole.parameters()[k]) / 2;
    EXPECT_NEAR(half.parameters()[k], expected, 1e-12 * (1 + std::abs(expected))) << k;
  }
}

TEST(FitStretches, StoppedItLeavesWhatItHas) {
  const Objective objective = MakeObjective(TableOf(Glossy({.along = 0.2, .across = 0.4}), kGrid),
                                            ModelSpec::SharedFactors(1, kGrid), "appearance");
  const FactorModel start = Glossy({});
  const FactorModel found = FitStretches(objective, start, [] { return true; }).model;
  EXPECT_FALSE(found.spec().stretches.any());
  EXPECT_TRUE(std::ranges::equal(found.parameters(), start.parameters()));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
