#include "trilobe/model/objective/repeat_noise.h"

#include <gtest/gtest.h>

#include <utility>

#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/objective/weighting.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr double kNoise = 0.05;

// Samples of a diffuser: `copies` of each direction with independent noise, light and eye exchanged
// in every other one.
BrdfSamples Repeated(int copies, double noise) {
  constexpr int kDirections = 1500;
  Random random(1);
  BrdfSamples samples;
  samples.source = "diffuser";
  for (int n = 0; n < kDirections; ++n) {
    const SphericalAngles at{.theta_i = random.Uniform(0, 1.3),
                             .phi_i = 0,
                             .theta_o = random.Uniform(0, 1.3),
                             .phi_o = random.Uniform(-kPi, kPi)};
    for (int k = 0; k < copies; ++k) {
      SphericalAngles own = at;
      if (k % 2 == 1) {
        std::swap(own.theta_i, own.theta_o);
        std::swap(own.phi_i, own.phi_o);
      }
      samples.directions.push_back(own);
      samples.angles.push_back(ToHalfDiff(ToDirections(own)));
      Rgb rho = {0.2, 0.3, 0.4};
      for (double& value : rho) value *= 1 + noise * random.Normal();
      samples.rho.push_back(rho);
    }
  }
  return samples;
}

Objective Of(BrdfSamples samples) {
  return {std::move(samples), ModelSpec::SharedFactors(1, {.theta_h = 8, .theta_d = 6}),
          Weightings().front()};
}

TEST(RepeatNoise, IsWhatAPerfectModelLeaves) {
  for (const int copies : {2, 3, 6}) {
    const std::optional<RepeatNoise> noise = NoiseOfRepeats(Of(Repeated(copies, kNoise)));
    ASSERT_TRUE(noise);
    EXPECT_EQ(noise->samples, 1500 * copies);
    EXPECT_NEAR(noise->relative_objective, kNoise * kNoise, 0.1 * kNoise * kNoise) << copies;
  }
}

TEST(RepeatNoise, IsKnownOfRepeatedSamplesThatDiffer) {
  EXPECT_FALSE(NoiseOfRepeats(Of(Repeated(1, kNoise))));
  EXPECT_FALSE(NoiseOfRepeats(Of(Repeated(2, 0))));
}

TEST(RepeatNoise, OfATableIsThatOfExchangedDirections) {
  BrdfSamples samples;
  samples.grid = {.theta_h = 8, .theta_d = 6, .phi_d = 12};
  samples.source = "table";
  Random random(2);
  for (int bin = 0; bin < 8 * 6 * 12; ++bin) {
    const Cosines cosines = ToCosines(samples.grid.Center(bin));
    if (cosines.i <= 0.1 || cosines.o <= 0.1) continue;
    samples.bins.push_back(bin);
    samples.rho.push_back({0.3 * (1 + kNoise * random.Normal()), 0.3, 0.3});
  }
  const std::optional<RepeatNoise> noise = NoiseOfRepeats(Of(std::move(samples)));
  ASSERT_TRUE(noise);
  // In one of three channels.
  EXPECT_NEAR(noise->relative_objective, kNoise * kNoise / 3, 0.2 * kNoise * kNoise / 3);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
