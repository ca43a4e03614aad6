#include "trilobe/model/stretch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "model/objective/lobes.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr double kTheta = 0.3, kHalfTurn = kPi / 2;

double ReadAt(const Stretch& stretch, const HalfDiffAngles& angles) {
  return stretch.ThetaH(angles.theta_h, {angles.theta_d, angles.phi_d});
}

TEST(Stretch, NoneIsTheIdentityToTheBit) {
  EXPECT_FALSE(Stretch().any());
  for (const double theta_h : {0.0, 0.1, 1.5}) {
    EXPECT_EQ(ReadAt(Stretch(), {theta_h, 1.2, 0.7}), theta_h);
  }
}

TEST(Stretch, WidensHighlightsByPowersOfTheCosine) {
  const Stretch stretch{.along = -0.5, .across = 0.25};
  EXPECT_TRUE(stretch.any());
  for (const double theta_d : {0.0, 0.5, 1.0, 1.4}) {
    const double cosine = std::cos(theta_d);
    // The half vector leans within the plane of both directions, or across it.
    EXPECT_NEAR(ReadAt(stretch, {kTheta, theta_d, 0}),
                std::min(kTheta * std::pow(cosine, -0.5), kPi / 2), 1e-15);
    EXPECT_NEAR(ReadAt(stretch, {kTheta, theta_d, kHalfTurn}), kTheta * std::pow(cosine, 0.25),
                1e-15);
    const double between = stretch.Factor({theta_d, kPi / 4});
    EXPECT_NEAR(between * between, (1 / cosine + std::sqrt(cosine)) / 2, 1e-12);
  }
  // Nothing changes at normal incidence, and nothing is infinite at grazing.
  EXPECT_EQ(stretch.Factor({0, 0.3}), 1);
  for (const double phi_d : {0.0, 0.5, kHalfTurn}) {
    const double read_at = ReadAt(stretch, {1.5, kPi / 2, phi_d});
    EXPECT_TRUE(read_at >= 0 && read_at <= kPi / 2) << phi_d;
  }
}

// A lobe of fixed width about the mirror direction has 0 and 1: so far from it in wo, whichever
// way, D is read at the same place.
TEST(Stretch, ZeroAndOneIsALobeAboutTheMirrorDirection) {
  const Stretch stretch{.along = 0, .across = 1};
  const Direction wi = {std::sin(1.0), 0, std::cos(1.0)};
  const double small = 1e-4;
  const Direction within = {-std::sin(1.0 + small), 0, std::cos(1.0 + small)};
  const Direction across = {-std::sin(1.0) * std::cos(small), std::sin(small),
                            std::cos(1.0) * std::cos(small)};
  const double along = ReadAt(stretch, ToHalfDiff({wi, within}));
  EXPECT_NEAR(along, small / 2, 1e-8);
  EXPECT_NEAR(ReadAt(stretch, ToHalfDiff({wi, across})), along, 1e-7);
}

TEST(Stretch, ExchangedDirectionsReadTheSame) {
  ModelSpec spec = ModelSpec::SharedFactors(2);
  spec.stretches = Stretch{.along = -0.6, .across = 0.4};
  const FactorModel model = RandomModel(spec, 1);
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const auto direction = [&random] {
      const double theta = random.Uniform(0, 1.5), phi = random.Uniform(0, 6);
      return Direction{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                       std::cos(theta)};
    };
    const DirectionPair pair{direction(), direction()};
    const Rgb rho = Evaluate(model, pair), exchanged = Evaluate(model, {pair.wo, pair.wi});
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(exchanged[c], rho[c], 1e-9 * rho[c]);
    }
  }
}

TEST(Stretches, LobesThatAreStretchedAlikeShareAReading) {
  constexpr Stretch kA{.along = 0.5, .across = 0}, kB{.along = 0, .across = -0.25};
  EXPECT_FALSE(Stretches().any());
  EXPECT_EQ(Stretches(), Stretches(Stretch()));
  EXPECT_EQ(Stretches(std::vector<Stretch>()), Stretches());
  EXPECT_EQ(Stretches(std::vector{kA, kA, kA}), Stretches(kA));
  EXPECT_FALSE(Stretches(kA).several());
  EXPECT_EQ(Stretches(kA).of(5), kA);

  const Stretches stretches(std::vector{kA, kB, kA});
  EXPECT_TRUE(stretches.any());
  EXPECT_TRUE(stretches.several());
  EXPECT_EQ(stretches.distinct(), (std::vector{kA, kB}));
  EXPECT_EQ(stretches.index(0), 0);
  EXPECT_EQ(stretches.index(1), 1);
  EXPECT_EQ(stretches.index(2), 0);
  EXPECT_EQ(stretches.of(1), kB);
  EXPECT_EQ(stretches.Select({1, 0}), Stretches(std::vector{kB, kA}));
  EXPECT_EQ(stretches.Select({0, 2}), Stretches(kA));
  EXPECT_EQ(stretches.Select({}), Stretches());
  EXPECT_TRUE(Stretches(std::vector{Stretch(), kB}).any());  // the first is none
}

// Each lobe by itself is what a model with its stretch alone makes of it.
TEST(Stretches, EachLobeHasItsOwn) {
  constexpr Stretch kA{.along = 0.5, .across = -0.2}, kB{.along = -0.3, .across = 0.8};
  ModelSpec spec = ModelSpec::SharedFactors(2);
  spec.stretches = Stretches(std::vector{kA, kB});
  const FactorModel model = RandomModel(spec, 3);
  Random random(4);
  for (int k = 0; k < 50; ++k) {
    const HalfDiffAngles angles{random.Uniform(0, 0.7), random.Uniform(0, 0.7),
                                random.Uniform(0, kPi)};
    const DirectionPair pair = ToDirections(angles);
    const Rgb rho = Evaluate(model, pair);
    Rgb sum{-model.d()[0], -model.d()[1], -model.d()[2]};  // is in both
    for (int m = 0; m < 2; ++m) {
      FactorModel alone = WithStretches(model, spec.stretches.of(m));
      std::ranges::fill(alone.s(1 - m), 0.0);
      const Rgb of_lobe = Evaluate(alone, pair);
      for (int c = 0; c < kChannels; ++c) sum[c] += of_lobe[c];
    }
    for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(sum[c], rho[c], 1e-12 * rho[c]);
  }
}

TEST(Stretch, BadOnesAreRefused) {
  const auto error_of = [](const ModelSpec& spec) { return ErrorOf([&] { CheckSpec(spec); }); };
  ModelSpec spec = ModelSpec::SharedFactors(1);
  for (const double bad : {2.1, -3.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    spec.stretches = Stretch{.along = 0, .across = bad};
    EXPECT_THAT(error_of(spec), IsError(ErrorKind::kRange, {.key = "stretch"})) << bad;
  }
  spec.stretches = Stretch{.along = -2, .across = 2};
  EXPECT_NO_THROW(CheckSpec(spec));
  spec = ModelSpec::SharedFactors(3);
  spec.stretches = Stretches({{.along = 0.1}, {.along = 0.2}});
  EXPECT_THAT(error_of(spec), IsError(ErrorKind::kMismatch, {.key = "stretches", .value = "2"}));
  spec.lobes = 2;
  EXPECT_NO_THROW(CheckSpec(spec));
  spec.D.per_lobe = false;
  EXPECT_THAT(error_of(spec), IsError(ErrorKind::kConflict, {.key = "stretches"}));
  spec = ModelSpec::Anisotropic(1);
  spec.stretches = Stretch{.along = 0.1};
  EXPECT_THAT(error_of(spec), IsError(ErrorKind::kUnsupported,
                                      {.key = "anisotropic", .value = "a stretch of highlights"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
