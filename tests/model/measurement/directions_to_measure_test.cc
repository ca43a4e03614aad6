#include "model/measurement/directions_to_measure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/error_of.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

double Degrees(double angle) { return RadiansToDegrees(angle); }

TEST(DirectionsToMeasure, AFewOfMoreAreTheFirst) {
  const std::vector<SphericalAngles> few = DirectionsToMeasure(7, {}),
                                     more = DirectionsToMeasure(60, {});
  ASSERT_EQ(few.size(), 7U);
  ASSERT_EQ(more.size(), 60U);
  for (size_t k = 0; k < few.size(); ++k) {
    EXPECT_EQ(few[k].theta_i, more[k].theta_i);
    EXPECT_EQ(few[k].phi_o, more[k].phi_o);
  }
}

// Each tenth of theta_h and theta_d, as far as they are reached together, has its share.
TEST(DirectionsToMeasure, AreSpreadOverHalfAndDifferenceAngles) {
  std::set<int> of_h, of_d, of_phi;
  for (const SphericalAngles& at : DirectionsToMeasure(100, {})) {
    EXPECT_LE(Degrees(at.theta_i), 80 + 1e-6);
    EXPECT_LE(Degrees(at.theta_o), 80 + 1e-6);
    EXPECT_EQ(at.phi_i, 0);
    EXPECT_GE(at.phi_o, 0);
    EXPECT_LE(at.phi_o, kPi);
    const HalfDiffAngles angles = ToHalfDiff(ToDirections(at));
    of_h.insert(static_cast<int>(Degrees(angles.theta_h) / 10));
    of_d.insert(static_cast<int>(Degrees(angles.theta_d) / 10));
    of_phi.insert(static_cast<int>(Degrees(angles.phi_d) / 30));
  }
  EXPECT_GE(of_h.size(), 7U);
  EXPECT_GE(of_d.size(), 7U);
  EXPECT_EQ(of_phi.size(), 6U);
}

TEST(DirectionsToMeasure, KeepToWhatTheDeviceCan) {
  Goniometer device;
  device.max_theta = DegreesToRadians(60);
  for (const double degrees : {10, 30, 50}) device.incidences.push_back(DegreesToRadians(degrees));
  device.step = DegreesToRadians(2.5);
  device.blind = DegreesToRadians(8);
  std::set<double> incidences;
  for (const SphericalAngles& at : DirectionsToMeasure(80, device)) {
    incidences.insert(std::round(Degrees(at.theta_i)));
    for (const double angle : {at.theta_o, at.phi_o}) {
      EXPECT_NEAR(std::remainder(Degrees(angle), 2.5), 0, 1e-9);
    }
    EXPECT_LE(Degrees(at.theta_o), 60 + 1e-9);
    const DirectionPair pair = ToDirections(at);
    EXPECT_GE(Degrees(std::acos(Dot(pair.wi, pair.wo))), 8 - 1e-6);
  }
  EXPECT_THAT(incidences, testing::ElementsAre(10, 30, 50));
  for (const bool fixed : {false, true}) {
    if (!fixed) device.incidences.clear();
    device.in_plane = true;
    for (const SphericalAngles& at : DirectionsToMeasure(20, device)) {
      EXPECT_TRUE(at.phi_o == 0 || at.phi_o == kPi) << at.phi_o;
    }
  }
}

// A step is the detector's where the light has angles of its own, and need not divide 180 degrees.
TEST(DirectionsToMeasure, GivenIncidencesAreKept) {
  Goniometer device;
  device.incidences = {DegreesToRadians(12.5), DegreesToRadians(45)};
  device.step = DegreesToRadians(7);
  for (const SphericalAngles& at : DirectionsToMeasure(40, device)) {
    const double theta_i = Degrees(at.theta_i);
    EXPECT_TRUE(std::abs(theta_i - 12.5) < 1e-9 || std::abs(theta_i - 45) < 1e-9) << theta_i;
    EXPECT_NEAR(std::remainder(Degrees(at.phi_o), 7), 0, 1e-9);
  }
}

// How many the device reaches does not depend on how many are asked for.
TEST(DirectionsToMeasure, AsManyAsAreReachedCanBeHad) {
  Goniometer device;
  device.step = DegreesToRadians(20);
  device.blind = DegreesToRadians(120);
  const auto thrown = ErrorOf([&] { DirectionsToMeasure(1000, device); });
  ASSERT_TRUE(thrown);
  int reached = 0;
  ASSERT_EQ(std::sscanf(thrown->what(), "the device reaches %d of", &reached), 1);
  EXPECT_GT(reached, 0);
  EXPECT_EQ(std::ssize(DirectionsToMeasure(reached, device)), reached);
}

// Nobody measures the same twice, nor what reciprocity tells.
TEST(DirectionsToMeasure, SayEachThingOnce) {
  Goniometer device;
  device.step = DegreesToRadians(20);
  std::set<std::string> known;
  for (const SphericalAngles& at : DirectionsToMeasure(40, device)) {
    const auto rounded = [](double angle) { return std::to_string(std::llround(Degrees(angle))); };
    const std::string phi = std::min(at.theta_i, at.theta_o) > 1e-6 ? rounded(at.phi_o) : "";
    EXPECT_TRUE(known.insert(rounded(at.theta_i) + " " + rounded(at.theta_o) + " " + phi).second);
    EXPECT_TRUE(at.theta_i == at.theta_o ||
                known.insert(rounded(at.theta_o) + " " + rounded(at.theta_i) + " " + phi).second);
  }
}

// Whatever the azimuth of the light, the order of the two, and the digits that a file keeps.
TEST(DirectionsToMeasure, WhatIsLeftGoesOnWithThePlan) {
  const std::vector<SphericalAngles> plan = DirectionsToMeasure(30, {});
  std::vector<SphericalAngles> measured(plan.begin(), plan.begin() + 20);
  for (size_t k = 0; k < measured.size(); ++k) {
    SphericalAngles& at = measured[k];
    if (k % 2 == 0) std::swap(at.theta_i, at.theta_o);
    for (double* const angle : {&at.theta_i, &at.theta_o, &at.phi_o}) {
      *angle = DegreesToRadians(std::round(100 * Degrees(*angle)) / 100);
    }
    at.phi_i = 1;
    at.phi_o = k % 3 == 0 ? 1 - at.phi_o : 1 + at.phi_o;
  }
  const std::vector<SphericalAngles> left = DirectionsLeft(10, {}, measured);
  ASSERT_EQ(left.size(), 10U);
  for (size_t k = 0; k < left.size(); ++k) {
    EXPECT_EQ(left[k].theta_i, plan[20 + k].theta_i);
    EXPECT_EQ(left[k].phi_o, plan[20 + k].phi_o);
  }
  // Along the normal no azimuth says anything.
  const Goniometer up{.incidences = {0}, .step = DegreesToRadians(30)};
  const double thirty = DegreesToRadians(30);
  for (const SphericalAngles& at :
       DirectionsLeft(2, up, std::vector<SphericalAngles>{{thirty, 2, 0, 5}})) {
    EXPECT_NE(at.theta_o, thirty);
  }
}

TEST(DirectionsToMeasure, WhatCannotBeIsOneLine) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto error = [](int count, const Goniometer& device) {
    const auto thrown = ErrorOf([&] { DirectionsToMeasure(count, device); });
    return std::string(thrown ? thrown->what() : "");
  };
  for (const int count : {0, -5, kMostDirections + 1}) {
    EXPECT_THAT(error(count, {}), testing::HasSubstr("give 1 to 100000"));
  }
  for (const double theta : {0.0, kPi / 2, kNan}) {
    EXPECT_THAT(error(1, {.max_theta = theta}), testing::HasSubstr("above 0 and below 90"));
  }
  EXPECT_THAT(error(1, {.incidences = {1.5}}), testing::HasSubstr("from 0 to theta_max"));
  EXPECT_THAT(error(1, {.incidences = {kNan}}), testing::HasSubstr("from 0 to theta_max"));
  EXPECT_THAT(error(1, {.step = 1}), testing::HasSubstr("to 45"));
  EXPECT_THAT(error(1, {.blind = -1}), testing::HasSubstr("below 180"));
  EXPECT_THAT(error(50, {.in_plane = true, .step = DegreesToRadians(40)}),
              testing::HasSubstr("the device reaches "));
  EXPECT_THAT(error(1, {.blind = 3.1}), testing::HasSubstr("reaches 0 of 1 directions"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
