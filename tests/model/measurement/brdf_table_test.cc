#include "trilobe/model/measurement/brdf_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kSmall{.theta_h = 4, .theta_d = 5, .phi_d = 6};

TEST(BrdfTable, MerlBinsAboveTheSurface) {  // docs/your-data.md
  const std::vector<bool> above = BinsAboveSurface(MerlGrid{});
  EXPECT_EQ(above.size(), 1'458'000U);
  EXPECT_EQ(std::ranges::count(above, true), 1'096'216);
}

TEST(BrdfTable, BinsAboveTheSurfaceComeInMirrorPairs) {
  const MerlGrid grid;
  const std::vector<bool> above = BinsAboveSurface(grid);
  int unequal = 0;
  for (int h = 0; h < grid.theta_h; ++h) {
    for (int d = 0; d < grid.theta_d; ++d) {
      for (int p = 0; p < grid.phi_d; ++p) {
        unequal += above[grid.Index(h, d, p)] != above[grid.Index(h, d, grid.phi_d - 1 - p)];
      }
    }
  }
  EXPECT_EQ(unequal, 0);
}

TEST(BrdfTable, ValuesAreScaledAsInMerlFiles) {
  BrdfTable table = MakeInvalidTable("t", kSmall);
  for (auto& plane : table.stored) plane[3] = 3000;
  EXPECT_DOUBLE_EQ(table.Value(0, 3), 2);
  EXPECT_DOUBLE_EQ(table.Value(1, 3), 2 * 1.15);
  EXPECT_DOUBLE_EQ(table.Value(2, 3), 2 * 1.66);
  table.SetValue(2, 4, 0.83);
  EXPECT_DOUBLE_EQ(table.stored[2][4], 750);
  EXPECT_DOUBLE_EQ(table.Value(2, 4), 0.83);
}

TEST(BrdfTable, AnInvalidTableHasNoValidBin) {
  const BrdfTable table = MakeInvalidTable("t", kSmall);
  EXPECT_EQ(std::ranges::count(ValidBins(table), true), 0);
  EXPECT_THAT(ErrorOf([&] { ValidSamples(table); }), IsError(ErrorKind::kData, {.key = "bins"}));
}

// Any one bad plane makes a bin invalid; bins below the surface are, whatever they hold.
TEST(BrdfTable, ValidBinsAreFiniteNonNegativeAndAboveTheSurface) {
  BrdfTable table = MakeInvalidTable("t", kSmall);
  for (auto& plane : table.stored) std::ranges::fill(plane, 1.0);
  const std::vector<bool> above = BinsAboveSurface(kSmall);
  EXPECT_EQ(ValidBins(table), above);
  const int bin = kSmall.Index(1, 2, 3);
  ASSERT_TRUE(above[bin]);
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (int c = 0; c < kChannels; ++c) {
    for (const double bad : {-1.0, -1e-300, kInf, -kInf, std::nan("")}) {
      BrdfTable broken = table;
      broken.stored[c][bin] = bad;
      std::vector<bool> expected = above;
      expected[bin] = false;
      EXPECT_EQ(ValidBins(broken), expected) << "channel " << c << ", " << bad;
    }
    for (const double good : {0.0, -0.0, 5e-324, 1e300}) {
      BrdfTable fine = table;
      fine.stored[c][bin] = good;
      EXPECT_EQ(ValidBins(fine), above) << "channel " << c << ", " << good;
    }
  }
}

TEST(BrdfTable, LimitAnglesLeavesOutWhatIsBeyondAndKeepsEarlierReasons) {
  BrdfTable table = MakeInvalidTable("t", kSmall);
  for (auto& plane : table.stored) std::ranges::fill(plane, 1.0);
  LimitAngles(kPi / 2, Unmeasured::kBeyondMaxAngle, &table);
  EXPECT_TRUE(table.unmeasured.empty());  // no limit
  const auto largest = [](int bin) {
    const auto [cos_i, cos_o] = ToCosines(kSmall.Center(bin));
    return std::acos(std::min(cos_i, cos_o));
  };
  const std::vector<bool> above = BinsAboveSurface(kSmall);
  LimitAngles(1.2, Unmeasured::kBeyondNodes, &table);
  LimitAngles(0.8, Unmeasured::kBeyondMaxAngle, &table);
  LimitAngles(1.0, Unmeasured::kExtrapolated, &table);  // nothing new
  EXPECT_EQ(table.max_theta, 0.8);
  const std::vector<bool> valid = ValidBins(table);
  for (int bin = 0; bin < kSmall.size(); ++bin) {
    const Unmeasured expected = !above[bin] || largest(bin) <= 0.8 ? Unmeasured::kNo
                                : largest(bin) > 1.2               ? Unmeasured::kBeyondNodes
                                                                   : Unmeasured::kBeyondMaxAngle;
    EXPECT_EQ(ReasonOf(table, bin), expected) << bin;
    EXPECT_EQ(valid[bin], above[bin] && expected == Unmeasured::kNo) << bin;
    EXPECT_EQ(table.stored[0][bin], 1.0);  // values stay
  }
  LimitAngles(0.001, Unmeasured::kBeyondMaxAngle, &table);
  EXPECT_THAT(ErrorOf([&] { ValidSamples(table); }),
              IsError(ErrorKind::kData, {.file = "t", .key = "bins"}));
}

TEST(BrdfSamples, AreTheValidBinsAscending) {
  const BrdfTable table = RandomTable(kSmall, 1, 0.5);
  const std::vector<bool> valid = ValidBins(table);
  const BrdfSamples samples = ValidSamples(table);
  EXPECT_TRUE(samples.on_grid());
  EXPECT_EQ(samples.source, "random");
  EXPECT_EQ(samples.size(), std::ranges::count(valid, true));
  int j = 0;
  for (int bin = 0; bin < kSmall.size(); ++bin) {
    if (!valid[bin]) continue;
    EXPECT_EQ(samples.bins[j], bin);
    EXPECT_EQ(samples.Angles(j).phi_d, kSmall.Center(bin).phi_d);
    for (int c = 0; c < kChannels; ++c) EXPECT_EQ(samples.rho[j][c], table.Value(c, bin));
    ++j;
  }
}

TEST(BrdfSamples, ScatteredOnesHaveAngles) {
  const BrdfSamples on_grid = ValidSamples(RandomTable(kSmall, 1));
  const BrdfSamples scattered = Scattered(on_grid);
  EXPECT_FALSE(scattered.on_grid());
  EXPECT_EQ(scattered.size(), on_grid.size());
  EXPECT_EQ(scattered.Angles(5).theta_d, on_grid.Angles(5).theta_d);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
