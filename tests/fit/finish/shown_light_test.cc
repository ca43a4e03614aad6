#include "fit/finish/shown_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

void Add(double theta_i, double theta_o, double phi, double rho, BrdfSamples* samples) {
  samples->directions.push_back(
      {DegreesToRadians(theta_i), 0, DegreesToRadians(theta_o), DegreesToRadians(phi)});
  samples->angles.push_back(ToHalfDiff(ToDirections(samples->directions.back())));
  samples->rho.push_back({rho, rho, rho});
}

FactorModel Diffuse(double albedo) {
  FactorModel diffuse(ModelSpec::SharedFactors(0));
  std::ranges::fill(diffuse.d(), albedo / kPi);
  return diffuse;
}

TEST(ShownLight, OfSamplesAllOverIsAboutWhatIsReflected) {
  BrdfSamples samples;
  for (int theta_i = 0; theta_i <= 80; theta_i += 10) {
    for (int theta_o = 0; theta_o <= 80; theta_o += 4) {
      for (int phi = 0; phi < 360; phi += 20) Add(theta_i, theta_o, phi, 5 / kPi, &samples);
    }
  }
  EXPECT_NEAR(ShownLight(samples, Diffuse(5), 1), 5, 0.3);
  EXPECT_NEAR(LimitByShown(samples, Diffuse(5), 1), 3 * kOfShown * 5, 3 * kOfShown * 0.3);
  for (Rgb& rho : samples.rho) rho.fill(0.4 / kPi);
  EXPECT_EQ(LimitByShown(samples, Diffuse(0.4), 1), 1);
}

// They tell the level of a diffuse base, in any units.
TEST(ShownLight, OfFewSamplesIsThatOfTheDarkest) {
  BrdfSamples samples;
  for (const double degrees : {10.0, 30.0, 50.0}) Add(degrees, 0, 0, 7 / kPi, &samples);
  EXPECT_NEAR(ShownLight(samples, Diffuse(0), 1), 7, 1e-9);
  samples.directions.clear();
  EXPECT_EQ(ShownLight(samples, Diffuse(5), 1), 0);
}

// Whatever a model says beside them.
TEST(ShownLight, OfAHighlightAloneIsWhatLiesInIt) {
  BrdfSamples samples;
  for (int theta_i = 0; theta_i <= 40; theta_i += 10) {
    for (int off = -5; off <= 5; ++off) Add(theta_i, std::abs(theta_i + off), 180, 10, &samples);
  }
  EXPECT_LT(ShownLight(samples, Diffuse(5), 1), 0.5);
  EXPECT_EQ(LimitByShown(samples, Diffuse(5), 1), 1);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
