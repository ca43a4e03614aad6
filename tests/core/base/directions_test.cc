#include "trilobe/core/base/directions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trilobe/core/base/merl_grid.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

double Dot(const Direction& a, const Direction& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Turned about the normal.
Direction Turned(const Direction& w, double phi) {
  return {std::cos(phi) * w[0] - std::sin(phi) * w[1], std::sin(phi) * w[0] + std::cos(phi) * w[1],
          w[2]};
}

// A spread of angles inside the ranges of docs/your-data.md.
std::vector<HalfDiffAngles> Spread() {
  const MerlGrid grid{.theta_h = 9, .theta_d = 9, .phi_d = 12};
  std::vector<HalfDiffAngles> angles;
  for (int bin = 0; bin < grid.size(); ++bin) angles.push_back(grid.Center(bin));
  return angles;
}

TEST(Directions, ToPolarAnglesAndBack) {
  for (const PolarAngles& at :
       {PolarAngles{0.3, 1}, PolarAngles{1e-7, -3}, PolarAngles{kPi / 2, 3.1}}) {
    Direction w = ToDirection(at);
    EXPECT_NEAR(Dot(w, w), 1, 1e-15);
    for (double& x : w) x *= 3;  // any length will do
    EXPECT_NEAR(ToPolarAngles(w).theta, at.theta, 1e-15);
    EXPECT_NEAR(ToPolarAngles(w).phi, at.phi, 1e-14);
  }
}

TEST(Directions, AreUnitVectorsWhoseBisectorIsTheHalfVector) {
  for (const HalfDiffAngles& a : Spread()) {
    const auto [wi, wo] = ToDirections(a);
    EXPECT_NEAR(Dot(wi, wi), 1, 1e-15);
    EXPECT_NEAR(Dot(wo, wo), 1, 1e-15);
    const Direction h = {std::sin(a.theta_h), 0, std::cos(a.theta_h)};
    EXPECT_NEAR(Dot(wi, h), std::cos(a.theta_d), 1e-15);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(wi[k] + wo[k], 2 * std::cos(a.theta_d) * h[k], 1e-15);
  }
}

TEST(Directions, ByHand) {
  // theta_h = 30 degrees in the xz plane, theta_d = 45, phi_d = 90: the difference vector points to
  // y, so that both directions share the half vector's share of x and z.
  const auto [wi, wo] = ToDirections(
      HalfDiffAngles{DegreesToRadians(30), DegreesToRadians(45), DegreesToRadians(90)});
  const double half = std::sqrt(0.5);
  EXPECT_NEAR(wi[0], half * 0.5, 1e-15);
  EXPECT_NEAR(wi[1], half, 1e-15);
  EXPECT_NEAR(wi[2], half * std::sqrt(0.75), 1e-15);
  EXPECT_NEAR(wo[1], -half, 1e-15);
  EXPECT_NEAR(wo[2], wi[2], 1e-15);

  // In the plane of incidence theta_i and theta_o are theta_d -+ theta_h.
  const Cosines cosines = ToCosines({DegreesToRadians(10), DegreesToRadians(25), 0});
  EXPECT_NEAR(cosines.i, std::cos(DegreesToRadians(35)), 1e-15);
  EXPECT_NEAR(cosines.o, std::cos(DegreesToRadians(15)), 1e-15);
}

TEST(Directions, RoundTrip) {
  for (const HalfDiffAngles& a : Spread()) {
    const auto [wi, wo] = ToDirections(a);
    for (const double phi : {0.0, 1.0, 2.5, 4.0, 6.0}) {  // the material is isotropic
      const HalfDiffAngles back = ToHalfDiff({Turned(wi, phi), Turned(wo, phi)});
      EXPECT_NEAR(back.theta_h, a.theta_h, 1e-14);
      EXPECT_NEAR(back.theta_d, a.theta_d, 1e-14);
      EXPECT_NEAR(back.phi_d, a.phi_d, 1e-12);
    }
  }
}

TEST(Directions, CosinesAreThoseOfTheDirections) {
  for (const HalfDiffAngles& a : Spread()) {
    const auto [wi, wo] = ToDirections(a);
    const Cosines cosines = ToCosines(a);
    EXPECT_NEAR(cosines.i, wi[2], 1e-15);
    EXPECT_NEAR(cosines.o, wo[2], 1e-15);
  }
}

// Reciprocity: exchanging wi and wo turns the difference vector by 180 degrees, out of [0, pi) and
// so back to the same angles.
TEST(Directions, ExchangingBothKeepsTheAngles) {
  for (const HalfDiffAngles& a : Spread()) {
    const auto [wi, wo] = ToDirections(a);
    const HalfDiffAngles swapped = ToHalfDiff({wo, wi});
    EXPECT_NEAR(swapped.theta_h, a.theta_h, 1e-14);
    EXPECT_NEAR(swapped.theta_d, a.theta_d, 1e-14);
    EXPECT_NEAR(swapped.phi_d, a.phi_d, 1e-12);
  }
}

// The fold by symmetry rests on this: phi_d -> 180 degrees - phi_d exchanges theta_i and theta_o.
TEST(Directions, MirroredPhiExchangesTheta) {
  for (const HalfDiffAngles& a : Spread()) {
    const Cosines cosines = ToCosines(a);
    const Cosines mirrored = ToCosines({a.theta_h, a.theta_d, kPi - a.phi_d});
    EXPECT_NEAR(mirrored.i, cosines.o, 1e-15);
    EXPECT_NEAR(mirrored.o, cosines.i, 1e-15);
  }
}

TEST(Directions, PhiStaysInRange) {
  for (const double phi : {0.0, 1e-17, 0.1, 3.0, kPi - 1e-9, std::nextafter(kPi, 0.0)}) {
    const HalfDiffAngles back = ToHalfDiff(ToDirections(HalfDiffAngles{0.4, 0.6, phi}));
    EXPECT_GE(back.phi_d, 0);
    EXPECT_LT(back.phi_d, kPi);
  }
}

TEST(Directions, DegenerateAnglesStayFinite) {
  const Direction normal = {0, 0, 1};
  const HalfDiffAngles both_normal = ToHalfDiff({normal, normal});
  EXPECT_EQ(both_normal.theta_h, 0);
  EXPECT_EQ(both_normal.theta_d, 0);
  EXPECT_GE(both_normal.phi_d, 0);
  EXPECT_LT(both_normal.phi_d, kPi);

  // Half vector on the normal: phi_d is counted from an arbitrary meridian.
  const HalfDiffAngles mirror = ToHalfDiff({{0.6, 0, 0.8}, {-0.6, 0, 0.8}});
  EXPECT_NEAR(mirror.theta_h, 0, 1e-15);
  EXPECT_NEAR(mirror.theta_d, std::asin(0.6), 1e-15);

  // Retro-reflection.
  const HalfDiffAngles retro = ToHalfDiff({{0.6, 0, 0.8}, {0.6, 0, 0.8}});
  EXPECT_NEAR(retro.theta_h, std::asin(0.6), 1e-15);
  EXPECT_NEAR(retro.theta_d, 0, 1e-15);
}

TEST(Directions, DegreesAndRadians) {
  EXPECT_DOUBLE_EQ(DegreesToRadians(180), kPi);
  EXPECT_DOUBLE_EQ(RadiansToDegrees(kPi / 3), 60);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
