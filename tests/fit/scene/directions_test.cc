#include "fit/scene/directions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <set>

#include "tests/error_of.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 12, .theta_d = 12, .phi_d = 24};

DirectionRanges Ranges(double min_i, double max_i, double min_o, double max_o) {
  return {{DegreesToRadians(min_i), DegreesToRadians(max_i)},
          {DegreesToRadians(min_o), DegreesToRadians(max_o)}};
}

DirectionHistogram Histogram(double count) {
  return {"h", kGrid, std::vector<double>(kGrid.size(), count)};
}

std::string HistogramBytes(const MerlGrid& grid, const std::vector<double>& counts) {
  std::string bytes;
  const auto append = [&](const auto& value) {
    bytes.append(std::bit_cast<std::array<char, sizeof(value)>>(value).data(), sizeof(value));
  };
  for (const int32_t size : {grid.theta_h, grid.theta_d, grid.phi_d}) append(size);
  for (const double count : counts) append(count);
  return bytes;
}

TEST(UsedSamples, AllAreTheSame) {
  const BrdfSamples samples = ValidSamples(RandomTable(kGrid, 1));
  const BrdfSamples used = UsedSamples(samples, AllDirections());
  EXPECT_EQ(used.bins, samples.bins);
  EXPECT_EQ(used.rho, samples.rho);
  EXPECT_TRUE(used.multiplicity.empty());
}

TEST(UsedSamples, RangesHoldTheAnglesInEitherOrder) {
  for (const bool scattered : {false, true}) {
    BrdfSamples samples = ValidSamples(RandomTable(kGrid, 2));
    if (scattered) samples = Scattered(std::move(samples));
    const BrdfSamples used = UsedSamples(samples, Ranges(10, 30, 40, 80));
    EXPECT_EQ(used.on_grid(), !scattered);
    int expected = 0, exchanged = 0;
    for (int j = 0; j < samples.size(); ++j) {
      const DirectionPair pair = ToDirections(samples.Angles(j));
      const double i = RadiansToDegrees(std::acos(pair.wi[2]));
      const double o = RadiansToDegrees(std::acos(pair.wo[2]));
      expected += i >= 10 && i <= 30 && o >= 40 && o <= 80;
      exchanged += o >= 10 && o <= 30 && i >= 40 && i <= 80;
    }
    EXPECT_GT(expected, 0);
    EXPECT_GT(exchanged, 0);
    EXPECT_EQ(used.size(), expected + exchanged);
  }
}

// Folding must find both bins of a pair, or neither.
TEST(UsedSamples, RangesAndListsKeepMirroredPairsTogether) {
  const BrdfSamples samples = ValidSamples(RandomTable(kGrid, 3));
  const std::set<int> valid(samples.bins.begin(), samples.bins.end());
  const SceneDirections forms[] = {Ranges(0, 60, 20, 90), Ranges(30, 90, 0, 20),
                                   DirectionList{{{0.2, 0.3, 0.4}, {0.7, 0.1, 3.1}}}};
  for (const SceneDirections& directions : forms) {
    const BrdfSamples used = UsedSamples(samples, directions);
    const std::set<int> kept(used.bins.begin(), used.bins.end());
    for (const int bin : kept) {
      const int p = bin % kGrid.phi_d, mirror = bin - p + kGrid.phi_d - 1 - p;
      EXPECT_EQ(kept.contains(mirror), valid.contains(mirror)) << bin;
    }
  }
}

TEST(UsedSamples, AListUsesTheBinsAroundEachDirection) {
  const BrdfSamples samples = ValidSamples(RandomTable(kGrid, 4, /*lost=*/0));
  const HalfDiffAngles center = kGrid.Center(3, 4, 5);
  // Just beyond a bin's centre in each coordinate: that bin and the next ones; in phi_d those that
  // are less than 10 degrees away.
  const HalfDiffAngles angles = {center.theta_h + 1e-6, center.theta_d + 1e-6, center.phi_d + 1e-6};
  const BrdfSamples used = UsedSamples(samples, DirectionList{{angles}});
  std::vector<int> expected;
  for (const int h : {3, 4}) {
    for (const int d : {4, 5}) {
      for (const int p : {4, 5, 6, 17, 18, 19}) expected.push_back(kGrid.Index(h, d, p));
    }
  }
  EXPECT_EQ(used.bins, expected);
  // phi_d is cyclic, the others end.
  const BrdfSamples at_the_edge = UsedSamples(samples, DirectionList{{{0, 0, 0}}});
  EXPECT_EQ(at_the_edge.bins, (std::vector<int>{kGrid.Index(0, 0, 0), kGrid.Index(0, 0, 23)}));
}

TEST(UsedSamples, AHistogramOfOnesChangesNoBit) {
  const BrdfTable table = RandomTable(kGrid, 5);
  const BrdfSamples all = ValidSamples(table);
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective plain(all, spec, FindWeighting("compressive"));
  const Objective counted(UsedSamples(all, Histogram(1)), spec, FindWeighting("compressive"));
  const FactorModel model = RandomModel(spec, 6);
  EXPECT_EQ(plain.Value(model), counted.Value(model));
  EXPECT_EQ(plain.MeasuredEnergy(), counted.MeasuredEnergy());
  EXPECT_EQ(plain.coverage(), counted.coverage());
  EXPECT_EQ(plain.folded()->weight, counted.folded()->weight);
  for (int j = 0; j < all.size(); ++j) {
    EXPECT_EQ(plain.Sample(j).weight, counted.Sample(j).weight);
  }
}

TEST(UsedSamples, AHistogramWeightsAndDrops) {
  const BrdfSamples all = ValidSamples(RandomTable(kGrid, 7));
  DirectionHistogram histogram = Histogram(0);
  Random random(8);
  for (double& count : histogram.counts) {
    count = random.Uniform() < 0.5 ? 0 : random.Uniform(0, 1000);
  }
  const BrdfSamples used = UsedSamples(all, histogram);
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective(used, spec, FindWeighting("log"));
  const Objective plain(all, spec, FindWeighting("log"));
  // E by hand, with the scale that makes the mean multiplicity 1.
  const FactorModel model = RandomModel(spec, 9);
  double sum = 0, counts = 0;
  int samples = 0;
  for (int j = 0; j < all.size(); ++j) {
    const double count = histogram.counts[all.bins[j]];
    const WeightedSample sample = plain.Sample(j);
    for (int c = 0; c < kChannels; ++c) {
      const double residual = sample.rho[c] - UnclampedValue(model, sample.stencils, c);
      sum += count * sample.weight[c] * residual * residual;
    }
    counts += count;
    samples += count > 0;
  }
  EXPECT_EQ(used.size(), samples);
  const double expected = sum / (counts / samples);
  EXPECT_NEAR(objective.Value(model), expected, 1e-12 * expected);
  EXPECT_NEAR(static_cast<double>(ExactObjective(objective, model)), expected, 1e-12 * expected);
  // Thinning keeps each sample's own.
  const BrdfSamples thinned = Thinned(used, 3);
  ASSERT_EQ(thinned.multiplicity.size(), thinned.rho.size());
  for (int j = 0; j < thinned.size(); ++j) {
    EXPECT_NEAR(thinned.multiplicity[j], histogram.counts[thinned.bins[j]] / (counts / samples),
                1e-12 * thinned.multiplicity[j]);
  }
}

TEST(UsedSamples, SayWhereNothingIsLeft) {
  const BrdfSamples samples = ValidSamples(RandomTable(kGrid, 10));
  EXPECT_THAT(ErrorOf([&] { UsedSamples(samples, Ranges(0, 0, 0, 0)); }),
              IsError(ErrorKind::kData, {.file = "random", .key = "directions"}));
  const DirectionHistogram other{"other.hist", {2, 2, 2}, std::vector<double>(8, 1.0)};
  EXPECT_THAT(ErrorOf([&] { UsedSamples(samples, other); }),
              IsError(ErrorKind::kMismatch,
                      {.file = "other.hist", .key = "histogram", .value = "2 x 2 x 2"}));
}

TEST(ParseHistogram, ReadsWhatItsFormatSays) {
  const MerlGrid grid{.theta_h = 1, .theta_d = 2, .phi_d = 3};
  const std::vector<double> counts = {0, 1, 2.5, 3, 4, 1e9};
  const DirectionHistogram histogram = ParseHistogram(HistogramBytes(grid, counts), "a.hist");
  EXPECT_EQ(histogram.grid, grid);
  EXPECT_EQ(histogram.counts, counts);
}

TEST(ParseHistogram, RefusesWhatIsNone) {
  const MerlGrid grid{.theta_h = 1, .theta_d = 1, .phi_d = 2};
  const auto error = [](const std::string& bytes) {
    return ErrorOf([&] { ParseHistogram(bytes, "a.hist"); });
  };
  const std::string good = HistogramBytes(grid, {1, 2});
  EXPECT_THAT(error(""),
              IsError(ErrorKind::kFormat, {.file = "a.hist", .key = "bytes", .value = "0"}));
  EXPECT_THAT(error(good.substr(0, 20)),
              IsError(ErrorKind::kFormat, {.key = "bytes", .value = "20"}));
  EXPECT_THAT(error(good + "x"), IsError(ErrorKind::kFormat, {.key = "bytes", .value = "29"}));
  EXPECT_THAT(error(HistogramBytes({0, 1, 2}, {})),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "0"}));
  EXPECT_THAT(error(HistogramBytes({1 << 20, 1 << 20, 1 << 20}, {})),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "1048576"}));
  EXPECT_THAT(error(HistogramBytes(grid, {0, 0})), IsError(ErrorKind::kData, {.key = "counts"}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(error(HistogramBytes(grid, {1, bad})),
                IsError(ErrorKind::kRange, {.key = "bin 1"}));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
