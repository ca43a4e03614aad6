#include "model/objective/lobes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 9, .theta_d = 8, .phi_d = 6};
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

constexpr MerlGrid kMergedGrid{.theta_h = 6, .theta_d = 5, .phi_d = 4};

double LargestDifference(const FactorModel& a, const FactorModel& b) {
  double largest = 0;
  for (int bin = 0; bin < kMergedGrid.size(); ++bin) {
    for (int c = 0; c < kChannels; ++c) {
      const double x = UnclampedValue(a, GridStencils(a.spec(), kMergedGrid, bin), c);
      const double y = UnclampedValue(b, GridStencils(b.spec(), kMergedGrid, bin), c);
      largest = std::max(largest, std::abs(x - y) / y);
    }
  }
  return largest;
}

// Calls `visit` for each lobe of the models whose lobes can be split.
template <typename Visit>
void ForEachLobe(const Visit& visit) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    if (!spec.D.per_lobe) continue;
    for (int lobe = 0; lobe < spec.lobes; ++lobe) {
      // Smooth enough for the spline of G to stay above 0: no term cancels another.
      const FactorModel model = RandomModel(spec, 1 + lobe, 0.2);
      visit(model, lobe, name + ", lobe " + std::to_string(lobe));
    }
  }
}

TEST(SplitLobe, KeepsTheValueEverywhere) {
  ForEachLobe([](const FactorModel& model, int lobe, const std::string& what) {
    const FactorModel split = SplitLobe(model, lobe);
    for (int bin = 0; bin < kGrid.size(); ++bin) {
      const SampleStencils at = GridStencils(model.spec(), kGrid, bin);
      const HalfDiffAngles angles = kGrid.Center(bin);
      const SampleStencils between = ScatteredStencils(
          model.spec(), {.theta_h = 0.9 * angles.theta_h, .theta_d = angles.theta_d, .phi_d = 1});
      for (const SampleStencils& stencils : {at, between}) {
        for (int c = 0; c < kChannels; ++c) {
          const double rho = UnclampedValue(model, stencils, c);
          // Sums of at most 8 terms, all > 0, with some 10 roundings each.
          EXPECT_NEAR(UnclampedValue(split, stencils, c), rho, 20 * kEpsilon * rho) << what;
        }
      }
    }
  });
}

TEST(SplitLobe, GivesTheNewLobeTheFlanks) {
  ForEachLobe([](const FactorModel& model, int lobe, const std::string& what) {
    const FactorModel split = SplitLobe(model, lobe);
    const int added = model.spec().lobes;
    ModelSpec expected = model.spec();
    expected.lobes = added + 1;
    std::vector<int> lobes(added);
    std::iota(lobes.begin(), lobes.end(), 0);
    lobes.push_back(lobe);
    expected.stretches = expected.stretches.Select(lobes);
    ASSERT_EQ(split.spec(), expected) << what;
    for (int c = 0; c < kChannels; ++c) {
      const auto before = model.D(lobe, c);
      const auto narrow = split.D(lobe, c), wide = split.D(added, c);
      double last_share = 1;
      for (int h = 0; h < kGrid.theta_h; ++h) {
        EXPECT_NEAR(narrow[h] + wide[h], before[h], 2 * kEpsilon * before[h]) << what;
        const double share = narrow[h] / before[h];
        EXPECT_LT(share, last_share) << what;
        last_share = share;
        if (h == 0) {
          EXPECT_GT(share, 0.9) << what;
        }
      }
      EXPECT_LT(last_share, 0.1) << what;
      EXPECT_TRUE(std::ranges::equal(split.s(added), model.s(lobe))) << what;
      EXPECT_TRUE(std::ranges::equal(split.F(added, c), model.F(lobe, c))) << what;
      EXPECT_TRUE(std::ranges::equal(split.G(added, c), model.G(lobe, c))) << what;
    }
  });
}

TEST(SplitLobe, LeavesTheOthersAlone) {
  ForEachLobe([](const FactorModel& model, int lobe, const std::string& what) {
    const FactorModel split = SplitLobe(model, lobe);
    EXPECT_TRUE(std::ranges::equal(split.d(), model.d())) << what;
    for (int m = 0; m < model.spec().lobes; ++m) {
      EXPECT_TRUE(std::ranges::equal(split.s(m), model.s(m))) << what;
      for (int c = 0; c < kChannels; ++c) {
        if (m != lobe) {
          EXPECT_TRUE(std::ranges::equal(split.D(m, c), model.D(m, c))) << what;
        }
        EXPECT_TRUE(std::ranges::equal(split.F(m, c), model.F(m, c))) << what;
        EXPECT_TRUE(std::ranges::equal(split.G(m, c), model.G(m, c))) << what;
      }
    }
  });
}

TEST(SplitLobe, SplitsNothingIntoNothing) {
  const FactorModel black(ModelSpec::SharedFactors(1, kGrid));
  EXPECT_THAT(SplitLobe(black, 0).parameters(), testing::Each(0));
}

TEST(SplitLobe, SaysWhyItCannot) {
  const auto error = [](const FactorModel& model, int lobe) {
    return ErrorOf([&] { SplitLobe(model, lobe); });
  };
  int shared = 0;
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    if (spec.D.per_lobe) continue;
    ++shared;
    EXPECT_THAT(error(RandomModel(spec, 1), 0),
                IsError(ErrorKind::kUnsupported, {.key = "lobe", .value = "0"}));
  }
  EXPECT_GT(shared, 0);
  EXPECT_THAT(error(RandomModel(ModelSpec::SharedFactors(kMaxLobes, kGrid), 1), 0),
              IsError(ErrorKind::kRange, {.key = "lobes", .value = "9"}));
  EXPECT_THAT(error(RandomModel(ModelSpec::SharedFactors(0, kGrid), 1), 0),
              IsError(ErrorKind::kRange, {.key = "lobe", .value = "0"}));
  EXPECT_THAT(error(RandomModel(ModelSpec::SharedFactors(2, kGrid), 1), 2),
              IsError(ErrorKind::kRange, {.key = "lobe", .value = "2"}));
  EXPECT_THAT(error(RandomModel(ModelSpec::SharedFactors(2, kGrid), 1), -1),
              IsError(ErrorKind::kRange, {.key = "lobe", .value = "-1"}));
}

TEST(StrongestLobe, HasTheLargestSumOfS) {
  FactorModel model = RandomModel(ModelSpec::SharedFactors(3, kGrid), 1);
  const auto set = [&](int lobe, const Rgb& s) { std::ranges::copy(s, model.s(lobe).begin()); };
  set(0, {0, 0, 5});
  set(1, {2, 2, 2});
  set(2, {3, 0, 0});
  EXPECT_EQ(StrongestLobe(model), 1);
  set(2, {4, 4, 0});
  EXPECT_EQ(StrongestLobe(model), 2);
  set(0, {8, 0, 0});  // the first of equals
  EXPECT_EQ(StrongestLobe(model), 0);
  for (int m = 0; m < 3; ++m) set(m, {0, 0, 0});
  EXPECT_EQ(StrongestLobe(model), 0);
}

TEST(MergeLobes, WithoutALobeThatReflectsNothingAllIsTheSame) {
  for (const NamedSpec& named : TestSpecs(kMergedGrid)) {
    FactorModel model = RandomModel(named.spec, 1);
    for (int m = 0; m < named.spec.lobes; ++m) {
      FactorModel without = model;
      std::ranges::fill(without.s(m), 0.0);
      EXPECT_LT(LargestDifference(WithoutLobe(without, m), without), 1e-14) << named.name;
    }
  }
}

TEST(MergeLobes, LobesThatDifferInSAndDAloneBecomeOneWithoutLoss) {
  FactorModel model = RandomModel(ModelSpec::SharedFactors(3, kMergedGrid), 1);
  std::ranges::copy(model.table(Factor::kG, 0), model.table(Factor::kG, 2).begin());
  std::ranges::copy(model.s(0), model.s(2).begin());
  for (double& s : model.s(2)) s *= 0.25;
  const FactorModel merged = WithLobesMerged(model, 0, 2);
  EXPECT_EQ(merged.spec().lobes, 2);
  EXPECT_LT(LargestDifference(merged, model), 1e-14);
}

TEST(MergeLobes, NamesLobesThatAreNotThere) {
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(2, kMergedGrid), 1);
  EXPECT_THAT(ErrorOf([&] { WithoutLobe(model, 2); }),
              IsError(ErrorKind::kRange, {.key = "lobe", .value = "2"}));
  EXPECT_THAT(ErrorOf([&] { WithLobesMerged(model, 0, -1); }),
              IsError(ErrorKind::kRange, {.key = "lobe", .value = "-1"}));
  EXPECT_THAT(ErrorOf([&] { WithLobesMerged(model, 1, 1); }),
              IsError(ErrorKind::kConflict, {.key = "lobe", .value = "1"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
