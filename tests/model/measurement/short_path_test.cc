#include "model/measurement/short_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

auto Numbers(const SphericalAngles& at) {
  return std::tuple(at.theta_i, at.phi_i, at.theta_o, at.phi_o);
}

SphericalAngles Degrees(double theta_i, double theta_o, double phi) {
  return {DegreesToRadians(theta_i), 0, DegreesToRadians(theta_o), DegreesToRadians(phi)};
}

// In no order.
std::vector<SphericalAngles> Scattered(int count) {
  std::vector<SphericalAngles> directions;
  const auto part = [](double x) { return x - std::floor(x); };
  for (int k = 0; k < count; ++k) {
    directions.push_back(Degrees(80 * part(0.618 * k), 80 * part(0.755 * k), 180 * part(0.57 * k)));
  }
  return directions;
}

TEST(ShortPath, HasTheSameDirectionsAndTakesMuchLess) {
  const AxisCosts costs{.of_radian = {1, 1, 2}};
  const std::vector<SphericalAngles> plan = Scattered(100);
  std::vector<SphericalAngles> path = AlongShortPath(plan, costs);
  EXPECT_EQ(Numbers(path.front()), Numbers(plan.front()));
  EXPECT_LT(PathCost(path, costs), 0.4 * PathCost(plan, costs));
  std::vector<SphericalAngles> all = plan;
  std::ranges::sort(all, {}, Numbers);
  std::ranges::sort(path, {}, Numbers);
  EXPECT_TRUE(std::ranges::equal(all, path, {}, Numbers, Numbers));
}

// The best way through a line of places that are given in disorder is along it.
TEST(ShortPath, IsTheBestAlongALine) {
  std::vector<SphericalAngles> line;
  for (const double theta_o : {0, 50, 20, 70, 10, 40, 30, 60}) {
    line.push_back(Degrees(30, theta_o, 180));
  }
  const std::vector<SphericalAngles> path = AlongShortPath(line, {});
  EXPECT_TRUE(std::ranges::is_sorted(path, {}, &SphericalAngles::theta_o));
  EXPECT_NEAR(PathCost(path, {}), DegreesToRadians(70), 1e-12);
}

// An axis that takes ten times as much moves less.
TEST(ShortPath, SparesADearAxis) {
  const std::vector<SphericalAngles> plan = Scattered(60);
  const AxisCosts light{.of_radian = {1, 0, 0}};
  const double dear = PathCost(AlongShortPath(plan, {.of_radian = {10, 1, 1}}), light);
  EXPECT_LT(dear, 0.6 * PathCost(AlongShortPath(plan, {}), light));
}

TEST(ShortPath, InThePlaneGoesThroughTheNormal) {
  const std::vector<SphericalAngles> two = {Degrees(30, 10, 0), Degrees(30, 10, 180)};
  EXPECT_NEAR(PathCost(two, {.in_plane = true}), DegreesToRadians(20), 1e-12);
  EXPECT_NEAR(PathCost(two, {}), kPi, 1e-12);
}

TEST(ShortPath, OfNoneOneOrTheSameIsAsGiven) {
  EXPECT_TRUE(AlongShortPath({}, {}).empty());
  EXPECT_EQ(AlongShortPath({Degrees(1, 2, 3)}, {}).size(), 1U);
  EXPECT_EQ(AlongShortPath({Degrees(1, 2, 3), Degrees(1, 2, 3)}, {}).size(), 2U);
}

TEST(ShortPath, RefusesTooManyAndCostsThatAreNone) {
  const std::vector<SphericalAngles> many(kMostOfPath + 1);
  EXPECT_THAT(ErrorOf([&] { AlongShortPath(many, {}); }),
              IsError(ErrorKind::kRange, {.key = "path", .value = "2001"}));
  for (const double cost :
       {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(ErrorOf([&] {
                  AlongShortPath({}, {.of_radian = {1, cost, 1}});
                }),
                IsError(ErrorKind::kRange, {.key = "path"}));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
