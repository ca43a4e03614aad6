#include "fit/finish/albedo_limit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "model/objective/gauge.h"
#include "tests/fit/finish/fitted.h"
#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 16, .theta_d = 18, .phi_d = 20};

// A grey lobe over a diffuse base, with G = cos theta times exp(rise) at the horizon.
FactorModel Grey(const MerlGrid& grid, double strength, double rise) {
  FactorModel model(ModelSpec::SharedFactors(1, grid));
  std::ranges::fill(model.parameters(), 1.0);
  std::ranges::fill(model.d(), 0.05);
  std::ranges::fill(model.s(0), strength);
  for (int k = 0; k < grid.theta_h; ++k) model.table(Factor::kD, 0)[k] = std::exp(-0.5 * k);
  const Axis& axis = model.spec().g_axis;
  for (int k = 0; k < axis.size; ++k) {
    const double t = axis.Theta(k) / (kPi / 2);
    model.table(Factor::kG, 0)[k] = std::cos(axis.Theta(k)) * std::exp(rise * std::pow(t, 4));
  }
  return model;
}

FactorModel Grey(double strength, double rise) { return Grey(kGrid, strength, rise); }

std::vector<Rgb> Albedos(const FactorModel& model, std::span<const double> theta_i) {
  const PreparedModel<double> prepared(model);
  return DirectionalAlbedos(
      [&](const DirectionPair& pair) { return prepared.Value(pair.wi, pair.wo); }, theta_i, 1);
}

double LargestAlbedo(const FactorModel& model) {
  std::vector<double> angles;
  for (const double degrees : {0.0, 50.0, 70.0, 80.0, 85.0, 88.0}) {
    angles.push_back(DegreesToRadians(degrees));
  }
  double largest = 0;
  for (const Rgb& albedo : Albedos(model, angles)) {
    largest = std::max(largest, std::ranges::max(albedo));
  }
  return largest;
}

Objective DataOf(const BrdfTable& table) {
  return {ValidSamples(table), ModelSpec::SharedFactors(1, kGrid), FindWeighting("appearance"), 1};
}

TEST(AlbedoLimit, WhatReflectsMoreThanItReceivesReflectsOne) {
  FactorModel model = Grey(3, 3);
  ASSERT_GT(LargestAlbedo(model), 1.1);
  const FactorModel before = model;
  AlbedoLimits one{.theta_i = {}, .beyond = std::vector<Rgb>(7, Rgb{1, 1, 1}), .beyond_theta = 1.5};
  for (const double degrees : {0.0, 45.0, 60.0, 70.0, 80.0, 85.0, 89.0}) {
    one.theta_i.push_back(DegreesToRadians(degrees));
  }
  const TableLayout layout = TableLayout::Full(model.spec());
  FactorModel threaded = model;
  EXPECT_TRUE(LimitAlbedo(one, kAllAngles, layout, 1, {}, &model));
  EXPECT_TRUE(LimitAlbedo(one, kAllAngles, layout, 3, {}, &threaded));
  EXPECT_TRUE(std::ranges::equal(model.parameters(), threaded.parameters()));
  for (const Rgb& albedo : Albedos(model, one.theta_i)) {
    for (const double x : albedo) EXPECT_LE(x, 1 + 2e-3);
  }
  EXPECT_GT(LargestAlbedo(model), 0.9);  // no more than it takes
  EXPECT_FALSE(LimitAlbedo(one, kAllAngles, layout, 1, {}, &model));
  // Only G has changed.
  for (const Factor factor : {Factor::kD, Factor::kF}) {
    EXPECT_TRUE(std::ranges::equal(model.table(factor, 0), before.table(factor, 0)));
  }
}

// Its light at 89.8 degrees comes from within, and no entry of G is beyond.
TEST(AlbedoLimit, WhatNoEntryBeyondCanLowerDoesNotKeepTheRest) {
  FactorModel model = Grey(3, 3);
  AlbedoLimits limits{.theta_i = {},
                      .beyond = std::vector<Rgb>(8, Rgb{1, 1, 1}),
                      .beyond_theta = DegreesToRadians(89.5)};
  for (const double degrees : {0.0, 45.0, 60.0, 70.0, 80.0, 85.0, 88.0, 89.8}) {
    limits.theta_i.push_back(DegreesToRadians(degrees));
  }
  ASSERT_GT(Albedos(model, limits.theta_i).back()[0], 1.1);
  ASSERT_GT(LargestAlbedo(model), 1.1);
  EXPECT_TRUE(LimitAlbedo(limits, kAllAngles, TableLayout::Full(model.spec()), 1, {}, &model));
  EXPECT_LE(LargestAlbedo(model), 1 + 2e-3);
}

TEST(AlbedoLimit, WhatReflectsLessStaysAsItIs) {
  FactorModel model = Grey(0.05, 0);
  ASSERT_LT(LargestAlbedo(model), 0.8);
  const FactorModel before = model;
  const AlbedoLimits limits = AlbedoLimitsOf(DataOf(TableOf(model, kGrid)), model);
  EXPECT_EQ(limits.everywhere, (Rgb{1, 1, 1}));
  for (const Rgb& limit : limits.beyond) EXPECT_EQ(limit, (Rgb{1, 1, 1}));
  EXPECT_FALSE(LimitAlbedo(limits, kAllAngles, TableLayout::Full(model.spec()), 1, {}, &model));
  EXPECT_TRUE(std::ranges::equal(model.parameters(), before.parameters()));
}

TEST(AlbedoLimit, OfAMeasurementInOtherUnitsIsWhatItReflects) {
  const FactorModel model = Grey(5, 0);
  const AlbedoLimits limits = AlbedoLimitsOf(DataOf(TableOf(model, kGrid)), model);
  for (const double x : limits.everywhere) EXPECT_NEAR(x, LargestAlbedo(model), 0.15 * x);
}

// Coarse angles pass a ridge that one node of G makes beside a narrow highlight.
TEST(AlbedoLimit, ASingleNodeDoesNotGlow) {
  constexpr MerlGrid kFine{.theta_h = 90, .theta_d = 90, .phi_d = 12};
  FactorModel model = Grey(kFine, 1000, 0);
  for (int k = 0; k < kFine.theta_h; ++k) {
    model.table(Factor::kD, 0)[k] = std::exp(-0.2 * k * k);
  }
  const Objective data(ValidSamples(TableOf(model, kFine)), model.spec(),
                       FindWeighting("appearance"), 1);
  const AlbedoLimits limits = AlbedoLimitsOf(data, model);
  std::vector<double> ridges;
  for (const double degrees : {31.5, 81.5}) {
    ridges.push_back(DegreesToRadians(degrees));
    model.table(Factor::kG, 0)[static_cast<int>(degrees)] *= 40;
  }
  for (const Rgb& albedo : Albedos(model, ridges)) ASSERT_GT(albedo[0], 1.2);
  EXPECT_TRUE(LimitAlbedo(limits, kAllAngles, TableLayout::Full(model.spec()), 1, {}, &model));
  for (const Rgb& albedo : Albedos(model, ridges)) EXPECT_LE(albedo[0], 1 + 2e-3);
}

// Measured up to 60 degrees, a lobe that explodes beyond is brought back to how its albedo goes on.
TEST(AlbedoLimit, BeyondTheDataTheAlbedoGoesOnAsWithin) {
  FactorModel model = Grey(0.05, 0);
  BrdfTable table = TableOf(model, kGrid);
  LimitAngles(DegreesToRadians(60), Unmeasured::kBeyondMaxAngle, &table);
  const Objective data = DataOf(table);
  const FactorModel right = model;
  const Axis& axis = model.spec().g_axis;
  for (int k = 0; k < axis.size; ++k) {
    if (!(data.coverage()[model.TableOffset(Factor::kG, 0) + k] > 0)) {
      model.table(Factor::kG, 0)[k] *= 100;
    }
  }
  const std::vector<double> beyond = {DegreesToRadians(76), DegreesToRadians(84)};
  ASSERT_GT(Albedos(model, beyond)[0][1], 3 * Albedos(right, beyond)[0][1]);
  EXPECT_TRUE(LimitAlbedo(AlbedoLimitsOf(data, model), kAllAngles, TableLayout::Full(model.spec()),
                          1, {}, &model));
  const std::vector<Rgb> expected = Albedos(right, beyond), limited = Albedos(model, beyond);
  for (size_t k = 0; k < beyond.size(); ++k) {
    EXPECT_NEAR(limited[k][1], expected[k][1], 0.6 * expected[k][1]);
  }
}

// The samples hold up the albedo within the data; beyond them it is lowered all the same.
TEST(AlbedoLimit, AtTheEndOfTheDataEntriesBeforeItStay) {
  FactorModel model = Grey(3, 3);
  BrdfTable table = TableOf(model, kGrid);
  LimitAngles(DegreesToRadians(60), Unmeasured::kBeyondMaxAngle, &table);
  const Objective data = DataOf(table);
  const AlbedoLimits limits = AlbedoLimitsOf(data, model);
  const double from = DegreesToRadians(57);
  ASSERT_GT(limits.beyond_theta, from);
  const std::vector<double> grazing = {DegreesToRadians(76), DegreesToRadians(84)};
  const FactorModel before = model;
  ASSERT_GT(Albedos(before, grazing)[1][0], 1.1);
  EXPECT_TRUE(LimitAlbedo(limits, from, TableLayout::Full(model.spec()), 1, {}, &model));
  const Axis& axis = model.spec().g_axis;
  for (int k = 0; k < axis.size; ++k) {
    if (axis.Theta(k) > from) continue;
    EXPECT_EQ(model.table(Factor::kG, 0)[k], before.table(Factor::kG, 0)[k]) << k;
  }
  for (const Rgb& albedo : Albedos(model, grazing)) {
    for (int c = 0; c < kChannels; ++c) EXPECT_LE(albedo[c], limits.everywhere[c] + 2e-3);
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
