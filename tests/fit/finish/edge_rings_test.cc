#include "fit/finish/edge_rings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "fit/finish/edge_course.h"
#include "tests/fit/finish/fitted.h"
#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 20, .theta_d = 30, .phi_d = 12};
constexpr double kEnd = DegreesToRadians(75);

const StopCheck kGoOn = [] { return false; };
const auto kAny = [](const FactorModel& /*model*/) { return true; };

// To what was measured within 75 degrees; without the rings that the solver leaves.
Solved FitModel() {
  BrdfTable table = Synthesize(FindSynthMaterial("copper"), 0.02, 1, kGrid);
  LimitAngles(kEnd, Unmeasured::kBeyondMaxAngle, &table);
  Solved solved =
      SolveFromFirstStart(MakeObjective(table, ModelSpec::SharedFactors(3, kGrid), "appearance"));
  auto& [objective, model] = solved;
  const TableLayout layout = TableLayout::Full(model.spec());
  model = WithoutEdgeRings(objective, model, layout, nullptr, kAny, kGoOn).value_or(model);
  return solved;
}

const Solved& FittedModel() {
  static const Solved fitted = FitModel();
  return fitted;
}

// G is this many times as large at all nodes near an angle.
FactorModel WithRing(double degrees, double times) {
  FactorModel model = FittedModel().model;
  const Axis& axis = model.spec().g_axis;
  for (int k = 0; k < axis.size; ++k) {
    if (std::abs(RadiansToDegrees(axis.Theta(k)) - degrees) > 2) continue;
    for (int t = 0; t < model.spec().num_tables(Factor::kG); ++t) {
      model.table(Factor::kG, t)[k] *= times;
    }
  }
  return model;
}

std::optional<FactorModel> Even(const FactorModel& uneven) {
  return WithoutEdgeRings(FittedModel().objective, uneven, TableLayout::Full(uneven.spec()),
                          nullptr, kAny, kGoOn);
}

TEST(EdgeRing, IsSeenWhereItIs) {
  EXPECT_LT(EdgeRingOf(FittedModel().model, 2).share, kSeenEdgeRing);
  for (const double times : {0.4, 2.5}) {
    const EdgeRing ring = EdgeRingOf(WithRing(79.5, times), 2);
    EXPECT_GT(ring.share, 2 * kSeenEdgeRing) << times;
    EXPECT_NEAR(RadiansToDegrees(ring.theta_i), 79.5, 2) << times;
    EXPECT_EQ(ring.share, EdgeRingOf(WithRing(79.5, times), 1).share);
  }
  EXPECT_EQ(EdgeRingOf(FactorModel(ModelSpec::AnisotropicFor(1, 12, kEnd)), 1).share, 0);
}

TEST(EdgeRing, GoesAndTheDataStay) {
  const Objective& objective = FittedModel().objective;
  for (const double times : {0.4, 2.5}) {
    const FactorModel uneven = WithRing(79.5, times);
    const std::optional<FactorModel> even = Even(uneven);
    ASSERT_TRUE(even) << times;
    EXPECT_LE(EdgeRingOf(*even, 2).share, kSeenEdgeRing) << times;
    EXPECT_LE(objective.Value(*even), 1.1 * objective.Value(uneven)) << times;
  }
}

TEST(EdgeRing, StaysIfThereIsNoneOrNoModelIsAcceptable) {
  EXPECT_FALSE(Even(FittedModel().model));
  const FactorModel uneven = WithRing(79.5, 2.5);
  const TableLayout layout = TableLayout::Full(uneven.spec());
  const auto none = [](const FactorModel& /*model*/) { return false; };
  const Objective& objective = FittedModel().objective;
  EXPECT_FALSE(WithoutEdgeRings(objective, uneven, layout, nullptr, none, kGoOn));
  EXPECT_FALSE(WithoutEdgeRings(objective, uneven, layout, nullptr, kAny, [] { return true; }));
}

TEST(EdgeRing, GoesWithinTheLimitOfLight) {
  const Solved& fitted = FittedModel();
  const LightLimit limit(fitted.objective, fitted.model);
  const FactorModel uneven = WithRing(79.5, 30);
  ASSERT_FALSE(limit.Exceeded(uneven).empty());
  const std::optional<FactorModel> even = WithoutEdgeRings(
      fitted.objective, uneven, TableLayout::Full(uneven.spec()), &limit, kAny, kGoOn);
  ASSERT_TRUE(even);
  EXPECT_TRUE(limit.Exceeded(*even).empty());
}

// F of e^(2 phi) and G / cos theta of e^-phi reflect the same at each angle.
TEST(ContinueTogether, KeepsWhatFactorsReflectTogether) {
  FactorModel model(ModelSpec::SharedFactors(1, kGrid));
  std::ranges::fill(model.parameters(), 1.0);
  const Axis &f = model.spec().f_axis, &g = model.spec().g_axis;
  const auto phi = [](double theta) { return 8 * theta * theta; };
  for (int t = 0; t < model.spec().num_tables(Factor::kF); ++t) {
    for (int k = 0; k < f.size; ++k) {
      model.table(Factor::kF, t)[k] = f.Theta(k) < kEnd ? std::exp(2 * phi(f.Theta(k))) : 3;
    }
  }
  for (int k = 0; k < g.size; ++k) {
    model.table(Factor::kG, 0)[k] =
        g.Theta(k) < kEnd ? std::cos(g.Theta(k)) * std::exp(-phi(g.Theta(k))) : 0.1;
  }
  const FactorModel before = model;
  ContinueTogether(kEnd, &model);
  for (int k = 0; k < f.size; ++k) {
    if (f.Theta(k) < kEnd) {
      EXPECT_EQ(model.F(0, 0)[k], before.F(0, 0)[k]);
    }
    const double q = model.G(0, 0)[k] / std::cos(g.Theta(k));
    EXPECT_NEAR(std::as_const(model).F(0, 0)[k] * q * q, 1, 1e-6) << k;
  }
}

TEST(FollowCourse, HardlyChangesWhatIsEven) {
  const Solved& fitted = FittedModel();
  FactorModel followed = fitted.model;
  const FactoredAlbedos albedos(fitted.model, AnglesOfCourse(), 2);
  FollowCourse(6, TableLayout::Full(followed.spec()), albedos, &followed);
  const double rise = fitted.objective.Value(followed) - fitted.objective.Value(fitted.model);
  EXPECT_LE(rise, 1e-3 * fitted.objective.MeasuredEnergy());
  FactorModel threaded = fitted.model;
  FollowCourse(6, TableLayout::Full(followed.spec()),
               FactoredAlbedos(fitted.model, AnglesOfCourse(), 1), &threaded);
  EXPECT_TRUE(std::ranges::equal(followed.parameters(), threaded.parameters()));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
