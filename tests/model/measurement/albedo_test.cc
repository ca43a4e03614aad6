#include "trilobe/model/measurement/albedo.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

std::vector<double> Angles() {
  std::vector<double> theta_i;
  for (double degrees = 0.5; degrees < 90; degrees += 1) {
    theta_i.push_back(DegreesToRadians(degrees));
  }
  return theta_i;
}

TEST(AlbedoTest, LambertianIsPiTimesD) {
  const BrdfFunction lambertian = [](const DirectionPair&) { return Rgb{0.1, 0.2, 0.3}; };
  for (const Rgb& albedo : DirectionalAlbedos(lambertian, Angles(), 1)) {
    for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(albedo[c], kPi * 0.1 * (c + 1), 1e-4);
  }
}

// A lobe that depends on theta_o alone, rho = (n + 2)/(2 pi) cos^n theta_o, reflects all the light.
TEST(AlbedoTest, IntegratesPowersOfTheCosine) {
  for (const double n : {1.0, 4.0, 20.0}) {
    const BrdfFunction lobe = [n](const DirectionPair& pair) {
      const double rho = (n + 2) / (2 * kPi) * std::pow(pair.wo[2], n);
      return Rgb{rho, rho, rho};
    };
    for (const double degrees : {0.0, 30.0, 60.0, 80.0, 89.0}) {
      EXPECT_NEAR(DirectionalAlbedo(lobe, DegreesToRadians(degrees))[0], 1, 2e-3) << degrees;
    }
  }
}

// rho = D(theta_h) / (4 (wi.h) cos theta_o) has the albedo integral of D over the half vectors that
// reflect into the upper hemisphere. At theta_i = 0 these are theta_h < 45 degrees, and for GGX
// with roughness alpha, D without its cosine, the closed form is
//   integral_0^{pi/4} D cos theta_h sin theta_h 2 pi d theta_h = 1 / (1 + alpha^2),
// since tan 45 degrees is 1. It holds however narrow the highlight is.
TEST(AlbedoTest, ResolvesNarrowHighlights) {
  for (const double alpha : {0.5, 0.1, 0.01, 0.002}) {
    const BrdfFunction lobe = [alpha](const DirectionPair& pair) {
      const HalfDiffAngles angles = ToHalfDiff(pair);
      const double s = std::sin(angles.theta_h), c = std::cos(angles.theta_h);
      const double distribution =
          alpha * alpha / (kPi * std::pow(s * s + alpha * alpha * c * c, 2));
      const double rho = distribution * c / (4 * std::cos(angles.theta_d) * pair.wo[2]);
      return Rgb{rho, rho, rho};
    };
    EXPECT_NEAR(DirectionalAlbedo(lobe, 0)[0], 1 / (1 + alpha * alpha), 2e-3) << alpha;
  }
}

TEST(AlbedoTest, IsTheSameForAnyNumberOfThreads) {
  const BrdfFunction brdf = [](const DirectionPair& pair) {
    return Rgb{pair.wo[2], std::sqrt(pair.wo[2]), pair.wi[2]};
  };
  EXPECT_EQ(DirectionalAlbedos(brdf, Angles(), 1), DirectionalAlbedos(brdf, Angles(), 3));
}

TEST(AlbedoPassesOneTest, InterpolatesTheFirstCrossing) {
  const std::vector<double> theta_i = {0.1, 0.2, 0.3, 0.4};
  const std::vector<Rgb> albedo = {{0.5, 1.5, 1}, {0.8, 0.5, 1}, {1.2, 0.5, 1}, {0.5, 0.5, 1}};
  EXPECT_NEAR(AlbedoPassesOne(theta_i, albedo, 0).value(), 0.25, 1e-12);
  EXPECT_EQ(AlbedoPassesOne(theta_i, albedo, 1).value(), 0.1);
  EXPECT_FALSE(AlbedoPassesOne(theta_i, albedo, 2).has_value());
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
