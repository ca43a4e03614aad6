#include "trilobe/model/prepared_model.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "tests/error_of.h"
#include "tests/model/materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Any two directions up to 85 degrees, where the values of all channels are above 0.
DirectionPair RandomPair(Random* random) {
  const double end = DegreesToRadians(85);
  const auto direction = [&] {
    return DirectionAt(random->Uniform(0, end), random->Uniform(-kPi, kPi));
  };
  return {direction(), direction()};
}

std::array<float, 3> Rounded(const Direction& w) {
  return {static_cast<float>(w[0]), static_cast<float>(w[1]), static_cast<float>(w[2])};
}

TEST(PreparedModelTest, EqualsTheReferenceForEveryForm) {
  std::vector<NamedModel> models = TestMaterials();
  for (const auto& [name, spec] : TestSpecs({.theta_h = 12, .theta_d = 10})) {
    models.push_back({name, RandomModel(spec, 5, 0.1)});
  }
  ModelSpec mixed = ModelSpec::Anisotropic(2);
  mixed.g_axis = {.rule = Axis::Rule::kSpline};
  models.push_back({"D over azimuths, G a spline", RandomModel(mixed, 6, 0.1)});
  for (const auto& [name, model] : models) {
    const PreparedModel<double> prepared(model);
    const PreparedModel<float> rounded(model);
    Random random(1);
    for (int k = 0; k < 500; ++k) {
      const DirectionPair pair = RandomPair(&random);
      const Rgb expected = Evaluate(model, pair), value = prepared.Value(pair.wi, pair.wo);
      const auto in_float = rounded.Value(Rounded(pair.wi), Rounded(pair.wo));
      std::vector<Rgb> lobes(prepared.lobes() + 1);
      prepared.LobeValues(pair.wi, pair.wo, lobes.data());
      lobes.back() = prepared.diffuse();
      for (int c = 0; c < kChannels; ++c) {
        double sum = 0;
        for (const Rgb& lobe : lobes) sum += lobe[c];
        ASSERT_NEAR(value[c], expected[c], 1e-11 * expected[c]) << name;
        ASSERT_NEAR(sum, value[c], 1e-14 * value[c]) << name;
        ASSERT_NEAR(in_float[c], expected[c], 2e-3 * expected[c]) << name;
      }
    }
  }
}

TEST(PreparedModelTest, ValuesOfManyPairsAreThoseOfEach) {
  for (const auto& [name, model] : TestMaterials()) {
    const PreparedModel<double> prepared(model);
    Random random(3);
    std::vector<Direction> wi(33), wo(33);
    for (size_t k = 0; k < wi.size(); ++k) {
      const DirectionPair pair = RandomPair(&random);
      wi[k] = pair.wi;
      wo[k] = pair.wo;
    }
    wi[5][2] = -wi[5][2];
    std::vector<Rgb> values(wi.size());
    prepared.Values(wi, wo, values);
    for (size_t k = 0; k < wi.size(); ++k) {
      EXPECT_EQ(values[k], prepared.Value(wi[k], wo[k])) << name;
    }
    values.pop_back();
    EXPECT_THAT(ErrorOf([&] { prepared.Values(wi, wo, values); }),
                IsError(ErrorKind::kMismatch, {.key = "wi", .value = "33"}));
    EXPECT_THAT(ErrorOf([&] {
                  prepared.Values(std::span(wi).first(3), std::span(wo).first(2),
                                  std::span(values).first(3));
                }),
                IsError(ErrorKind::kMismatch, {.key = "wi", .value = "3"}));
  }
}

TEST(PreparedModelTest, OfAnglesIsThatOfTheirDirections) {
  for (const auto& [name, model] : TestMaterials()) {
    if (model.spec().anisotropic()) continue;
    const PreparedModel<double> prepared(model);
    Random random(4);
    for (int k = 0; k < 500; ++k) {
      const HalfDiffAngles angles = {random.Uniform(0, kPi / 2), random.Uniform(0, kPi / 2),
                                     random.Uniform(0, kPi)};
      const auto [wi, wo] = ToDirections(angles);
      const Rgb expected = prepared.Value(wi, wo);
      const Rgb value = prepared.Value(angles, Cosines{wi[2], wo[2]});
      for (int c = 0; c < kChannels; ++c) {
        ASSERT_NEAR(value[c], expected[c], 1e-9 * expected[c]) << name;
      }
    }
    const Cosines up = {0.5, 0.5};
    const double none = std::numeric_limits<double>::quiet_NaN(), huge = 1e300;
    for (const HalfDiffAngles& bad :
         {HalfDiffAngles{none, 0.3, 0.3}, {0.3, none, 0.3}, {-1, 0.3, 0.3}, {0.3, -1, 0.3}}) {
      EXPECT_FALSE(prepared.Value(bad, up)[0] > 0) << name;
    }
    EXPECT_EQ(prepared.Value(HalfDiffAngles{0.3, 0.3, 0.3}, Cosines{-0.1, 0.5}), Rgb{}) << name;
    EXPECT_TRUE(std::isfinite(prepared.Value(HalfDiffAngles{huge, huge, huge}, up)[0])) << name;
  }
}

TEST(PreparedModelTest, IsReciprocal) {
  for (const auto& [name, model] : TestMaterials()) {
    const PreparedModel<double> prepared(model);
    Random random(2);
    for (int k = 0; k < 100; ++k) {
      const DirectionPair pair = RandomPair(&random);
      const Rgb value = prepared.Value(pair.wi, pair.wo), other = prepared.Value(pair.wo, pair.wi);
      for (int c = 0; c < kChannels; ++c) ASSERT_NEAR(value[c], other[c], 1e-12 * value[c]) << name;
    }
  }
}

TEST(PreparedModelTest, IsZeroBelowTheSurfaceAndOfNoDirections) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const Direction up = {0, 0, 1};
  const Direction bad[] = {{0.6, 0, -0.8},   {1, 0, 0},          {0, 0, 0},
                           {nan, 0, 1},      {0, nan, 1},        {0, 0, nan},
                           {0, 0, infinity}, {infinity, 0, 0.1}, {-infinity, 0, 0.1}};
  for (const auto& [name, model] : TestMaterials()) {
    const PreparedModel<double> prepared(model);
    for (const Direction& w : bad) {
      EXPECT_EQ(prepared.Value(w, up), Rgb{}) << name;
      EXPECT_EQ(prepared.Value(up, w), Rgb{}) << name;
    }
    const Rgb grazing = prepared.Value({1, 0, 1e-300}, {-1, 0, 1e-300});
    for (const double x : grazing) EXPECT_TRUE(x >= 0) << name;
    for (const double x : prepared.Value({1, 0, 1e-300}, {0, 1, 1e-300})) {
      EXPECT_TRUE(x >= 0) << name;
    }
  }
}

// A negative weight of the spline makes a negative G of these tables, and of that no value.
TEST(PreparedModelTest, IsZeroWhereTheSplineThroughGIsNegative) {
  FactorModel model(ModelSpec::SharedFactors(1, {.theta_h = 12, .theta_d = 10}));
  for (double& x : model.parameters()) x = 1;
  for (double& d : model.d()) d = 0;
  for (double& g : model.table(Factor::kG, 0)) g = 0;
  model.table(Factor::kG, 0)[5] = 1;
  const PreparedModel<double> prepared(model);
  const double step = kPi / 2 / model.spec().g_axis.size, node = 5.5 * step;
  const Direction wi = DirectionAt(node, 0);
  EXPECT_EQ(prepared.Value(wi, DirectionAt(node + 1.5 * step, 1)), Rgb{});
  EXPECT_GT(prepared.Value(wi, DirectionAt(node + 0.5 * step, 1))[0], 0.1);
}

TEST(PreparedModelTest, RefusesParametersThatAreNone) {
  FactorModel model(ModelSpec::SharedFactors(1));
  model.s(0)[1] = -1;
  EXPECT_THAT(ErrorOf([&] { PreparedModel<double>{model}; }),
              IsError(ErrorKind::kData, {.key = "parameter 4", .value = "-1"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
