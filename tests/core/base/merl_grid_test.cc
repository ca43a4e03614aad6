#include "trilobe/core/base/merl_grid.h"

#include <gtest/gtest.h>

#include <set>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(MerlGrid, IndexIsPhiFastestThetaHSlowest) {
  const MerlGrid grid;
  EXPECT_EQ(grid.size(), 1'458'000);
  EXPECT_EQ(grid.Index(0, 0, 0), 0);
  EXPECT_EQ(grid.Index(0, 0, 1), 1);
  EXPECT_EQ(grid.Index(0, 1, 0), 180);
  EXPECT_EQ(grid.Index(1, 0, 0), 180 * 90);
  EXPECT_EQ(grid.Index(12, 34, 56), 56 + 180 * (34 + 90 * 12));
  EXPECT_EQ(grid.Index(89, 89, 179), grid.size() - 1);
}

TEST(MerlGrid, BinsOfOtherResolutionsAreNumberedOnce) {
  const MerlGrid grid{.theta_h = 4, .theta_d = 5, .phi_d = 7};
  std::set<int> seen;
  for (int h = 0; h < 4; ++h) {
    for (int d = 0; d < 5; ++d) {
      for (int p = 0; p < 7; ++p) seen.insert(grid.Index(h, d, p));
    }
  }
  EXPECT_EQ(seen.size(), 140U);
  EXPECT_EQ(*seen.begin(), 0);
  EXPECT_EQ(*seen.rbegin(), grid.size() - 1);
}

// theta_h bin i covers [(i/90)^2 90, ((i+1)/90)^2 90) degrees; theta_d and phi_d bins are 1 degree.
TEST(MerlGrid, BinEdges) {
  const MerlGrid grid;
  EXPECT_EQ(grid.ThetaH(0), 0);
  EXPECT_NEAR(RadiansToDegrees(grid.ThetaH(1)), 90.0 / 8100, 1e-16);
  EXPECT_NEAR(RadiansToDegrees(grid.ThetaH(30)), 10, 1e-13);
  EXPECT_NEAR(RadiansToDegrees(grid.ThetaH(45)), 22.5, 1e-13);
  EXPECT_NEAR(RadiansToDegrees(grid.ThetaH(90)), 90, 1e-13);
  EXPECT_NEAR(RadiansToDegrees(grid.ThetaD(17)), 17, 1e-13);
  EXPECT_NEAR(RadiansToDegrees(grid.PhiD(123)), 123, 1e-13);
}

TEST(MerlGrid, CentresAreInIndexSpace) {
  const MerlGrid grid;
  const HalfDiffAngles centre = grid.Center(9, 20, 100);
  EXPECT_NEAR(RadiansToDegrees(centre.theta_h), 9.5 * 9.5 / 90, 1e-14);
  EXPECT_NEAR(RadiansToDegrees(centre.theta_d), 20.5, 1e-13);
  EXPECT_NEAR(RadiansToDegrees(centre.phi_d), 100.5, 1e-13);
  const HalfDiffAngles by_number = grid.Center(grid.Index(9, 20, 100));
  EXPECT_EQ(by_number.theta_h, centre.theta_h);
  EXPECT_EQ(by_number.theta_d, centre.theta_d);
  EXPECT_EQ(by_number.phi_d, centre.phi_d);
}

TEST(MerlGrid, EveryCentreLiesInItsBin) {
  for (const MerlGrid& grid :
       {MerlGrid{}, MerlGrid{.theta_h = 7, .theta_d = 11, .phi_d = 13}, MerlGrid{4, 4, 1}}) {
    int wrong = 0;
    for (int bin = 0; bin < grid.size(); ++bin) wrong += grid.Bin(grid.Center(bin)) != bin;
    EXPECT_EQ(wrong, 0);
  }
}

TEST(MerlGrid, CoordinatesInvertTheEdges) {
  const MerlGrid grid{.theta_h = 31, .theta_d = 17, .phi_d = 8};
  for (double x = 0; x <= 17; x += 0.25) {
    EXPECT_NEAR(grid.ThetaHCoordinate(grid.ThetaH(x)), x, 1e-13);
    EXPECT_NEAR(grid.ThetaDCoordinate(grid.ThetaD(x)), x, 1e-13);
  }
}

TEST(MerlGrid, AnglesJustInsideAnEdgeAndAtTheEnds) {
  const MerlGrid grid;
  const double inside = 1e-9;
  EXPECT_EQ(grid.Bin({grid.ThetaH(30) + inside, 0, 0}), grid.Index(30, 0, 0));
  EXPECT_EQ(grid.Bin({grid.ThetaH(30) - inside, 0, 0}), grid.Index(29, 0, 0));
  EXPECT_EQ(grid.Bin({0, grid.ThetaD(41) + inside, 0}), grid.Index(0, 41, 0));
  EXPECT_EQ(grid.Bin({0, grid.ThetaD(41) - inside, 0}), grid.Index(0, 40, 0));
  EXPECT_EQ(grid.Bin({0, 0, grid.PhiD(90) + inside}), grid.Index(0, 0, 90));
  EXPECT_EQ(grid.Bin({0, 0, grid.PhiD(90) - inside}), grid.Index(0, 0, 89));
  EXPECT_EQ(grid.Bin({0, 0, 0}), 0);
  EXPECT_EQ(grid.Bin({kPi / 2, kPi / 2, kPi}), grid.size() - 1);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
