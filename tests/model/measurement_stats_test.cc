#include "trilobe/model/measurement_stats.h"

#include <gtest/gtest.h>

#include <limits>

namespace trilobe {
namespace {

constexpr MerlGrid kGrid = {.theta_h = 6, .theta_d = 6, .phi_d = 8};

BrdfTable ConstantTable(double value) {
  BrdfTable table = MakeInvalidTable("constant", kGrid);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    for (int c = 0; c < kChannels; ++c) table.SetValue(c, bin, value);
  }
  return table;
}

TEST(CountBinsTest, GivesEachBinOneReason) {
  BrdfTable table = ConstantTable(0.5);
  table.stored[1][kGrid.Index(0, 0, 0)] = -1;
  table.stored[2][kGrid.Index(0, 0, 1)] = std::numeric_limits<double>::quiet_NaN();
  table.stored[0][kGrid.Index(0, 0, 1)] = -1;
  table.stored[0][kGrid.Index(0, 0, 2)] = std::numeric_limits<double>::infinity();
  const BinCounts bins = CountBins(table);
  EXPECT_EQ(bins.total, kGrid.size());
  EXPECT_EQ(bins.negative, 1);
  EXPECT_EQ(bins.non_finite, 2);
  EXPECT_GT(bins.below_surface, 0);
  EXPECT_EQ(bins.valid + bins.below_surface + 3, bins.total);
}

TEST(CountBinsTest, MerlGridHasTheKnownNumberAboveTheSurface) {
  EXPECT_EQ(CountBins(MakeInvalidTable("empty", {})).negative, 1096216);
}

TEST(RangeOfValidBinsTest, IgnoresInvalidBins) {
  BrdfTable table = ConstantTable(0.5);
  table.SetValue(0, kGrid.Index(0, 0, 0), 2);
  table.SetValue(1, kGrid.Index(0, 0, 1), 0.25);
  table.SetValue(2, kGrid.Index(0, 0, 2), 99);
  table.SetValue(0, kGrid.Index(0, 0, 2), -1);
  const ValueRange range = RangeOfValidBins(table);
  EXPECT_DOUBLE_EQ(range.max[0], 2);
  EXPECT_DOUBLE_EQ(range.min[1], 0.25);
  EXPECT_DOUBLE_EQ(range.max[2], 0.5);
  EXPECT_EQ(RangeOfValidBins(MakeInvalidTable("empty", kGrid)).max[0], 0);
}

TEST(ExchangeErrorTest, ComparesMirroredBins) {
  BrdfTable table = ConstantTable(1);
  EXPECT_EQ(ExchangeError(table).median, 0);
  for (int row = 0; row < kGrid.size(); row += kGrid.phi_d) {
    for (int p = 0; p < kGrid.phi_d / 2; ++p) {
      for (int c = 0; c < kChannels; ++c) table.SetValue(c, row + p, 3);
    }
  }
  const PairError error = ExchangeError(table);
  EXPECT_NEAR(error.median, 1, 1e-12);  // |3 - 1| / 2
  EXPECT_NEAR(error.percentile_95, 1, 1e-12);
  EXPECT_EQ(2 * error.pairs, CountBins(table).valid);
  EXPECT_EQ(ExchangeError(MakeInvalidTable("empty", kGrid)).pairs, 0);
  EXPECT_EQ(ExchangeError(ConstantTable(0)).percentile_95, 0);  // 0 against 0 is equal
}

TEST(ReciprocityErrorTest, ComparesSwappedDirections) {
  const BrdfFunction reciprocal = [](const DirectionPair& pair) {
    const double x = pair.wi[2] * pair.wo[2];
    return Rgb{x, x, x};
  };
  const PairError none = ReciprocityError(reciprocal, kGrid, 2);
  EXPECT_EQ(none.percentile_95, 0);
  EXPECT_GT(none.pairs, 0);
  const BrdfFunction lopsided = [](const DirectionPair& pair) {
    const double x = pair.wi[0] > pair.wo[0] ? 3 : 1;
    return Rgb{x, x, x};
  };
  EXPECT_NEAR(ReciprocityError(lopsided, kGrid, 2).median, 1, 1e-12);
}

}  // namespace
}  // namespace trilobe
