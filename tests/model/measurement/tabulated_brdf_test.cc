#include "trilobe/model/measurement/tabulated_brdf.h"

#include <gtest/gtest.h>

#include "tests/error_of.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid = {.theta_h = 8, .theta_d = 9, .phi_d = 10};

// Red: h, green: d, blue: p.
BrdfTable PositionTable() {
  BrdfTable table = MakeInvalidTable("test", kGrid);
  const std::vector<bool> above = BinsAboveSurface(kGrid);
  for (int h = 0; h < kGrid.theta_h; ++h) {
    for (int d = 0; d < kGrid.theta_d; ++d) {
      for (int p = 0; p < kGrid.phi_d; ++p) {
        const int bin = kGrid.Index(h, d, p);
        if (!above[bin]) continue;
        table.SetValue(0, bin, h);
        table.SetValue(1, bin, d);
        table.SetValue(2, bin, p);
      }
    }
  }
  return table;
}

void ExpectNear(const Rgb& actual, const Rgb& expected) {
  for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(actual[c], expected[c], 1e-9) << "channel " << c;
}

DirectionPair At(double h, double d, double p) {
  return ToDirections(HalfDiffAngles{kGrid.ThetaH(h), kGrid.ThetaD(d), kGrid.PhiD(p)});
}

TEST(TabulatedBrdfTest, GivesTheBinThatContainsTheDirections) {
  const BrdfTable table = PositionTable();
  const TabulatedBrdf brdf(table);
  ExpectNear(brdf(At(2.9, 3.1, 4.2)), {2, 3, 4});
  ExpectNear(brdf(At(3.1, 3.9, 9.9)), {3, 3, 9});
}

TEST(TabulatedBrdfTest, InterpolatesBetweenCentres) {
  const BrdfTable table = PositionTable();
  const TabulatedBrdf brdf(table);
  ExpectNear(brdf.Interpolate(At(2.5, 3.5, 4.5)), {2, 3, 4});
  ExpectNear(brdf.Interpolate(At(2.75, 3.25, 4.9)), {2.25, 2.75, 4.4});
  // phi_d wraps: between the last bin (9) and the first (0).
  ExpectNear(brdf.Interpolate(At(2.5, 3.5, 9.75)), {2, 3, 9 * 0.75});
  ExpectNear(brdf.Interpolate(At(2.5, 3.5, 0.25)), {2, 3, 9 * 0.25});
}

TEST(TabulatedBrdfTest, IsBlackBelowTheSurface) {
  const BrdfTable table = PositionTable();
  const TabulatedBrdf brdf(table);
  const DirectionPair below = {{0.6, 0, 0.8}, {0.8, 0, -0.6}};
  ExpectNear(brdf(below), {0, 0, 0});
  ExpectNear(brdf.Interpolate(below), {0, 0, 0});
}

TEST(TabulatedBrdfTest, FillsAnInvalidBinFromTheNearestInPhi) {
  BrdfTable table = PositionTable();
  for (const int p : {0, 1, 8, 9}) table.stored[1][kGrid.Index(2, 3, p)] = -1;
  const TabulatedBrdf brdf(table);
  ExpectNear(brdf(At(2.5, 3.5, 1.5)), {2, 3, 2});
  ExpectNear(brdf(At(2.5, 3.5, 8.5)), {2, 3, 7});
  EXPECT_NEAR(brdf(At(2.5, 3.5, 0.5))[2], 2, 1e-9);
}

TEST(TabulatedBrdfTest, FillsAnEmptyRowFromTheNearestTheta) {
  BrdfTable table = PositionTable();
  for (int p = 0; p < kGrid.phi_d; ++p) table.stored[0][kGrid.Index(2, 3, p)] = -1;
  const TabulatedBrdf brdf(table);
  ExpectNear(brdf(At(2.5, 3.5, 4.5)), {2, 2, 4});
  for (int bin = 0; bin < 4 * kGrid.theta_d * kGrid.phi_d; ++bin) table.stored[0][bin] = -1;
  EXPECT_NEAR(TabulatedBrdf(table)(At(2.5, 1.5, 4.5))[0], 4, 1e-9);
}

TEST(TabulatedBrdfTest, RejectsATableWithoutAValidBin) {
  const BrdfTable table = MakeInvalidTable("nothing.binary", kGrid);
  EXPECT_THAT(ErrorOf([&] { TabulatedBrdf{table}; }), IsError(ErrorKind::kData, {.key = "bins"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
