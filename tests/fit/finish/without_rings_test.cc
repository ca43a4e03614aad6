#include "fit/finish/without_rings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/fit/finish/fitted.h"
#include "tests/test_util.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 20, .theta_d = 30, .phi_d = 12};

const StopCheck kGoOn = [] { return false; };
const auto kAny = [](const FactorModel& /*model*/) { return true; };

const Solved& FittedModel() {
  static const Solved fitted =
      SolveFromFirstStart(MakeObjective(Synthesize(FindSynthMaterial("copper"), 0.1, 1, kGrid),
                                        ModelSpec::SharedFactors(3, kGrid), "appearance"));
  return fitted;
}

// All that reaches or leaves the surface at one angle is brighter by a half.
FactorModel WithRing(FactorModel model) {
  const Axis& axis = model.spec().g_axis;
  for (int t = 0; t < model.spec().num_tables(Factor::kG); ++t) {
    model.table(Factor::kG, t)[axis.size / 2] *= 1.5;
  }
  return model;
}

TEST(WithoutRings, IsSmoother) {
  const Solved& fitted = FittedModel();
  ASSERT_FALSE(HasRings(fitted.model, 2));
  const FactorModel uneven = WithRing(fitted.model);
  ASSERT_TRUE(HasRings(uneven, 2));
  const std::optional<FactorModel> even = WithoutRings(fitted.objective, uneven, kAny, kGoOn);
  ASSERT_TRUE(even);
  EXPECT_FALSE(HasRings(*even, 2));
  EXPECT_LT(fitted.objective.Value(*even), fitted.objective.Value(uneven));
}

TEST(WithoutRings, IsNothingForAnEvenModelOrIfNoneIsAcceptable) {
  const Solved& fitted = FittedModel();
  EXPECT_FALSE(WithoutRings(fitted.objective, fitted.model, kAny, kGoOn));
  const FactorModel uneven = WithRing(fitted.model);
  const auto none = [](const FactorModel& /*model*/) { return false; };
  EXPECT_FALSE(WithoutRings(fitted.objective, uneven, none, kGoOn));
  EXPECT_FALSE(WithoutRings(fitted.objective, uneven, kAny, [] { return true; }));
}

TEST(WithoutRings, AsksOnlyForEvenModels) {
  const Solved& fitted = FittedModel();
  const auto is_even = [](const FactorModel& model) {
    EXPECT_FALSE(HasRings(model, 1));
    return true;
  };
  EXPECT_TRUE(WithoutRings(fitted.objective, WithRing(fitted.model), is_even, kGoOn));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
