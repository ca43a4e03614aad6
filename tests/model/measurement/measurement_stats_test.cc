#include "trilobe/model/measurement/measurement_stats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace trilobe::TRILOBE_TEST_FILE {
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

TEST(CountBinsTest, CountsWhatWasNotMeasured) {
  BrdfTable table = ConstantTable(0.5);
  const int above = CountBins(table).valid;
  table.unmeasured.assign(kGrid.size(), Unmeasured::kNo);
  table.unmeasured[kGrid.Index(0, 0, 0)] = Unmeasured::kExtrapolated;
  table.unmeasured[kGrid.Index(0, 0, 1)] = Unmeasured::kExtrapolated;
  table.unmeasured[kGrid.Index(0, 0, 2)] = Unmeasured::kBeyondNodes;
  table.unmeasured[kGrid.Index(0, 0, 3)] = Unmeasured::kBeyondMaxAngle;
  table.stored[1][kGrid.Index(0, 0, 0)] = -1;  // lost comes first
  const BinCounts bins = CountBins(table);
  EXPECT_EQ(bins.negative, 1);
  EXPECT_EQ(bins.extrapolated, 1);
  EXPECT_EQ(bins.beyond_nodes, 1);
  EXPECT_EQ(bins.beyond_max_angle, 1);
  EXPECT_EQ(bins.valid, above - 4);
  EXPECT_EQ(bins.below_surface, bins.total - above);
  EXPECT_EQ(2 * ExchangeError(table).pairs, above - 8);  // the partners of the four, too
}

TEST(ValidSharesTest, CountsByAngles) {
  BrdfTable table = ConstantTable(0.5);
  table.grid = {};
  for (auto& plane : table.stored) plane.assign(table.grid.size(), 0.5);
  LimitAngles(DegreesToRadians(60), Unmeasured::kBeyondMaxAngle, &table);
  const std::vector<double> shares = ValidShares(table);
  ASSERT_EQ(shares.size(), 8100U);
  for (int i = 0; i < 90; ++i) {
    for (int o = 0; o < 90; ++o) {
      const double share = shares[i * 90 + o];
      if (std::isnan(share)) continue;  // a cell without a bin
      EXPECT_EQ(share, i < 60 && o < 60 ? 1 : 0) << i << ", " << o;
    }
  }
  // Exchanged directions have a bin each, so what is left out for one of them shows.
  EXPECT_EQ(std::isnan(shares[20]), std::isnan(shares[20 * 90]));
  EXPECT_LT(std::ranges::count_if(shares, [](double x) { return std::isnan(x); }), 100);
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
  // There is no pair if one order was not measured.
  const auto measured = [](const DirectionPair& pair) { return pair.wi[0] <= pair.wo[0]; };
  EXPECT_LT(ReciprocityError(lopsided, kGrid, 2, measured).pairs, none.pairs / 2);
  EXPECT_EQ(ReciprocityError(lopsided, kGrid, 2, measured).median, 0);
}

TEST(ErrorOfPairsTest, IsFiniteForTheSmallestAndLargestValues) {
  constexpr double kLeast = std::numeric_limits<double>::denorm_min();
  constexpr double kMost = std::numeric_limits<double>::max();
  const std::vector<std::pair<Rgb, Rgb>> pairs = {{{kLeast, 0, kMost}, {0, kMost, kMost}},
                                                  {{0, kLeast, kMost}, {kLeast, 0, kMost / 2}}};
  const PairError error = ErrorOfPairs(pairs);
  EXPECT_EQ(error.pairs, 2);
  EXPECT_EQ(error.median, 2);
  EXPECT_EQ(error.percentile_95, 2);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
