#include "trilobe/model/measurement/measured_share.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 60, .theta_d = 60, .phi_d = 40};

BrdfSamples At(const std::vector<SphericalAngles>& directions) {
  BrdfSamples samples;
  samples.directions = directions;
  for (const SphericalAngles& at : directions) {
    samples.angles.push_back(ToHalfDiff(ToDirections(at)));
    samples.rho.push_back({1, 1, 1});
  }
  return samples;
}

// All pairs with both directions up to theta have the share sin^4 theta.
TEST(MeasuredShare, OfATableIsThatOfItsDirections) {
  FactorModel model(ModelSpec::SharedFactors(1, kGrid));
  std::ranges::fill(model.parameters(), 1.0);
  BrdfTable table = TableOf(model, kGrid);
  EXPECT_NEAR(MeasuredShare(ValidSamples(table)), 1, 1e-12);
  for (const double degrees : {75, 60, 45}) {
    LimitAngles(DegreesToRadians(degrees), Unmeasured::kBeyondMaxAngle, &table);
    EXPECT_NEAR(MeasuredShare(ValidSamples(table)),
                std::pow(std::sin(DegreesToRadians(degrees)), 4), 0.02);
  }
}

TEST(MeasuredShare, OfAGoniometersGridIsAllThatItReaches) {
  std::vector<SphericalAngles> grid, one;
  for (int i = 0; i <= 75; i += 15) {
    for (int o = 0; o <= 75; o += 15) {
      for (int phi = 0; phi < 360; phi += 15) {
        grid.push_back({.theta_i = DegreesToRadians(i),
                        .phi_i = 0,
                        .theta_o = DegreesToRadians(o),
                        .phi_o = DegreesToRadians(phi)});
        if (i == 45) one.push_back(grid.back());
      }
    }
  }
  EXPECT_GT(MeasuredShare(At(grid)), 0.95);  // sin^4 of 82.5 degrees is 0.966
  // One incidence: a quarter of all, twice for exchanged directions, less where both are there.
  EXPECT_NEAR(MeasuredShare(At(one)), 0.45, 0.05);
  // The order of the two directions does not matter, nor does a turn of the sample.
  for (SphericalAngles& at : one) {
    at = {.theta_i = at.theta_o, .phi_i = 1, .theta_o = at.theta_i, .phi_o = 1 - at.phi_o};
  }
  EXPECT_NEAR(MeasuredShare(At(one)), 0.45, 0.05);
}

TEST(MeasuredShare, OfOneDirectionManyTimesIsNextToNothing) {
  const SphericalAngles one{
      .theta_i = DegreesToRadians(45), .phi_i = 0, .theta_o = DegreesToRadians(45), .phi_o = 3};
  EXPECT_LT(MeasuredShare(At(std::vector<SphericalAngles>(300, one))), 0.02);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
