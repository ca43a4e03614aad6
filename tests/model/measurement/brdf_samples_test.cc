#include "trilobe/model/measurement/brdf_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kEven{.theta_h = 10, .theta_d = 9, .phi_d = 24};
constexpr MerlGrid kFine{.theta_h = 10, .theta_d = 8, .phi_d = 24};
constexpr MerlGrid kOdd{.theta_h = 10, .theta_d = 9, .phi_d = 23};  // one bin is its own mirror

// Rows as long as MERL's, for strides up to that of the solver multistart.
constexpr MerlGrid kLong{.theta_h = 7, .theta_d = 6, .phi_d = 180};
constexpr int kLongestStride = 24;

int LongestStride(const MerlGrid& grid) { return grid == kLong ? kLongestStride : 8; }

// A sample in every bin, also in those below the surface; its value is its number.
BrdfSamples Dense(const MerlGrid& grid) {
  BrdfSamples samples{"dense", grid, {}, {}, {}};
  for (int bin = 0; bin < grid.size(); ++bin) {
    samples.bins.push_back(bin);
    samples.rho.push_back({1.0 * bin, 2.0 * bin, 3.0 * bin});
  }
  return samples;
}

TEST(Thinned, IsAPartOfTheSamplesInTheirOrder) {
  for (const int stride : {1, 2, 3, 5, 8, 100}) {
    for (const bool scattered : {false, true}) {
      BrdfSamples samples = ValidSamples(RandomTable(kOdd, 1));
      if (scattered) samples = Scattered(std::move(samples));
      const BrdfSamples thinned = Thinned(samples, stride);
      EXPECT_EQ(thinned.source, samples.source);
      EXPECT_EQ(thinned.grid, samples.grid);
      EXPECT_EQ(thinned.on_grid(), samples.on_grid());
      ASSERT_EQ(thinned.bins.size() + thinned.angles.size(), thinned.rho.size());
      int next = 0;
      for (int j = 0; j < thinned.size(); ++j, ++next) {
        const auto same = [&] {
          return thinned.rho[j] == samples.rho[next] &&
                 (scattered ? thinned.angles[j].theta_h == samples.angles[next].theta_h &&
                                  thinned.angles[j].theta_d == samples.angles[next].theta_d &&
                                  thinned.angles[j].phi_d == samples.angles[next].phi_d
                            : thinned.bins[j] == samples.bins[next]);
        };
        while (next < samples.size() && !same()) ++next;
        ASSERT_LT(next, samples.size()) << "stride " << stride << ", sample " << j;
      }
      if (scattered) {
        EXPECT_NEAR(thinned.size(), 1.0 * samples.size() / stride, 2);
      }
      if (stride == 1) {
        EXPECT_EQ(thinned.size(), samples.size());
      }
      if (scattered) {
        EXPECT_EQ(thinned.size(), (samples.size() + stride - 1) / stride);
      }
    }
  }
}

// Places that few samples read keep more of them, and each counts for those that it stands for.
TEST(EvenlySpread, IsOfAllPhiDAndOfAboutSoMany) {
  const BrdfSamples samples = ValidSamples(RandomTable(kLong, 3, /*lost=*/0));
  EXPECT_EQ(EvenlySpread(samples, samples.size()).size(), samples.size());
  const int count = samples.size() / 6;
  const BrdfSamples spread = EvenlySpread(samples, count);
  EXPECT_NEAR(spread.size(), count, 0.5 * count);
  std::vector<int> seen(kLong.phi_d, 0);
  for (const int bin : spread.bins) ++seen[bin % kLong.phi_d];
  EXPECT_GT(std::ranges::min(seen), 0);
  EXPECT_THAT(ErrorOf([&] { EvenlySpread(samples, 0); }),
              IsError(ErrorKind::kRange, {.key = "the number of samples", .value = "0"}));
}

TEST(ThinnedByPlace, KeepsWhatIsRareAndCountsItRight) {
  const BrdfSamples all = ValidSamples(RandomTable(kLong, 3, /*lost=*/0));
  for (const bool scattered : {false, true}) {
    const BrdfSamples samples = scattered ? Scattered(all) : all;
    constexpr int kStride = 8, kLeast = 20;
    const BrdfSamples thinned = ThinnedByPlace(samples, kStride, kLeast);
    EXPECT_LT(thinned.size(), samples.size() / 2);
    const auto by_theta_h = [&](const BrdfSamples& some) {
      std::vector<int> counts(kLong.theta_h, 0);
      for (int j = 0; j < some.size(); ++j) {
        const double h = kLong.ThetaHCoordinate(some.Angles(j).theta_h);
        ++counts[std::clamp(static_cast<int>(h), 0, kLong.theta_h - 1)];
      }
      return counts;
    };
    const std::vector<int> before = by_theta_h(samples), after = by_theta_h(thinned);
    for (int h = 0; h < kLong.theta_h; ++h) {
      EXPECT_GE(after[h], std::min(before[h], kLeast) / 2) << h;
    }
    double count = 0;
    for (int j = 0; j < thinned.size(); ++j) {
      const double multiplicity = thinned.Multiplicity(j);
      EXPECT_TRUE(multiplicity >= 1 && multiplicity <= kStride) << multiplicity;
      count += multiplicity;
    }
    EXPECT_NEAR(count, samples.size(), 0.05 * samples.size());
  }
  // Thinned once more, the same share of each is left.
  const BrdfSamples twice = Thinned(ThinnedByPlace(all, 8, 20), 4);
  double count = 0;
  for (int j = 0; j < twice.size(); ++j) count += 4 * twice.Multiplicity(j);
  EXPECT_NEAR(count, all.size(), 0.1 * all.size());
  const BrdfSamples same = ThinnedByPlace(all, 1, 1);
  EXPECT_EQ(same.bins, all.bins);
  EXPECT_EQ(ThinnedByPlace(all, 100, all.size()).bins, all.bins);  // all are rare
  EXPECT_THAT(ErrorOf([&] { ThinnedByPlace(all, 0, 1); }),
              IsError(ErrorKind::kRange, {.key = "stride", .value = "0"}));
  EXPECT_THAT(ErrorOf([&] { ThinnedByPlace(all, 1, 0); }),
              IsError(ErrorKind::kRange, {.key = "least", .value = "0"}));
}

TEST(Thinned, KeepsMirroredPairsTogether) {
  for (const MerlGrid& grid : {kEven, kOdd, kLong}) {
    const BrdfSamples samples = ValidSamples(RandomTable(grid, 2));
    const std::set<int> valid(samples.bins.begin(), samples.bins.end());
    for (int stride = 2; stride <= LongestStride(grid); ++stride) {
      const BrdfSamples thinned = Thinned(samples, stride);
      const std::set<int> kept(thinned.bins.begin(), thinned.bins.end());
      int pairs = 0;
      for (const int bin : kept) {
        const int p = bin % grid.phi_d, mirror = bin - p + grid.phi_d - 1 - p;
        EXPECT_EQ(kept.contains(mirror), valid.contains(mirror)) << stride << ", bin " << bin;
        pairs += mirror != bin && kept.contains(mirror);
      }
      EXPECT_GT(pairs, 0);
    }
  }
}

// Thinning keeps n / stride of n pairs in a row, rounded up or down.
TEST(Thinned, TakesTheSameShareOfEveryRow) {
  for (const MerlGrid& grid : {kEven, kOdd, kLong}) {
    const BrdfSamples samples = Dense(grid);
    const int pairs = (grid.phi_d + 1) / 2;
    for (int stride = 1; stride <= LongestStride(grid); ++stride) {
      std::vector<int> of_row(grid.theta_h * grid.theta_d, 0);
      const BrdfSamples thinned = Thinned(samples, stride);
      for (const int bin : thinned.bins) {
        of_row[bin / grid.phi_d] += 2 * (bin % grid.phi_d) < grid.phi_d;
      }
      for (const int count : of_row) {
        EXPECT_GE(count, pairs / stride) << stride;
        EXPECT_LE(count, (pairs + stride - 1) / stride) << stride;
        EXPECT_GT(count, 0) << stride;
      }
    }
  }
}

// If neighbouring rows kept the same phi_d, whole stripes of directions would go unseen.
TEST(Thinned, BeginsNeighbouringRowsApart) {
  const BrdfSamples samples = Dense(kLong);
  for (int stride = 2; stride <= kLongestStride; ++stride) {
    const BrdfSamples thinned = Thinned(samples, stride);
    const std::set<int> kept(thinned.bins.begin(), thinned.bins.end());
    const auto first = [&](int h, int d) {
      int p = 0;
      while (!kept.contains(kLong.Index(h, d, p))) ++p;
      return p;
    };
    for (int h = 0; h + 1 < kLong.theta_h; ++h) {
      for (int d = 0; d + 1 < kLong.theta_d; ++d) {
        EXPECT_NE(first(h, d), first(h + 1, d)) << stride;
        EXPECT_NE(first(h, d), first(h, d + 1)) << stride;
      }
    }
  }
}

// Each row as it was or not at all, and none next to another one.
TEST(InEveryOtherRow, KeepsRowsAsOnAChessboard) {
  for (const MerlGrid& grid : {kEven, kOdd, kLong}) {
    const BrdfSamples samples = Dense(grid);
    const BrdfSamples kept = InEveryOtherRow(samples);
    std::vector<int> of_row(grid.theta_h * grid.theta_d, 0);
    for (const int bin : kept.bins) ++of_row[bin / grid.phi_d];
    for (int h = 0; h < grid.theta_h; ++h) {
      for (int d = 0; d < grid.theta_d; ++d) {
        EXPECT_EQ(of_row[h * grid.theta_d + d], (h + d) % 2 == 0 ? grid.phi_d : 0);
      }
    }
    for (int j = 0; j < kept.size(); ++j) EXPECT_EQ(kept.rho[j][0], kept.bins[j]);
  }
}

TEST(InEveryOtherRow, KeepsOneOfSamplesThatAreAllElsewhere) {
  const BrdfSamples samples = Dense(kEven);
  EXPECT_EQ(InEveryOtherRow(Selected(samples, {kEven.Index(0, 1, 0)})).size(), 1);
  EXPECT_EQ(InEveryOtherRow(Selected(samples, {})).size(), 0);
  EXPECT_THAT(ErrorOf([&] { InEveryOtherRow(Scattered(ValidSamples(RandomTable(kEven, 1)))); }),
              IsError(ErrorKind::kUnsupported, {.key = "rows"}));
}

// Against the sums over all samples, bin by bin of the coarse grid.
TEST(MeansOfFourBins, AreMeansOfTheSamplesInABin) {
  const BrdfTable table = RandomTable(kFine, 3, 0.3);  // with gaps
  const BrdfSamples samples = ValidSamples(table);
  const std::set<int> valid(samples.bins.begin(), samples.bins.end());
  const BrdfSamples means = MeansOfFourBins(samples, 1);
  const MerlGrid half{kFine.theta_h / 2, kFine.theta_d / 2, kFine.phi_d};
  EXPECT_EQ(means.grid, half);
  EXPECT_EQ(means.source, samples.source);
  EXPECT_NO_THROW(CheckSamples(means));
  const std::vector<bool> above = BinsAboveSurface(half);
  int next = 0;
  for (int bin = 0; bin < half.size(); ++bin) {
    const int row = bin / half.phi_d, p = bin % half.phi_d;
    const int h = 2 * (row / half.theta_d), d = 2 * (row % half.theta_d);
    double sum = 0, count = 0;
    for (const int fine : {kFine.Index(h, d, p), kFine.Index(h, d + 1, p), kFine.Index(h + 1, d, p),
                           kFine.Index(h + 1, d + 1, p)}) {
      if (!valid.contains(fine)) continue;
      sum += table.Value(1, fine);
      ++count;
    }
    if (count == 0 || !above[bin]) continue;
    ASSERT_LT(next, means.size());
    EXPECT_EQ(means.bins[next], bin);
    EXPECT_NEAR(means.rho[next][1], sum / count, 1e-15 + 1e-12 * sum);
    EXPECT_EQ(means.Multiplicity(next), count);
    ++next;
  }
  EXPECT_EQ(next, means.size());
}

TEST(MeansOfFourBins, WeighSamplesByHowOftenTheyCount) {
  BrdfSamples samples = Selected(Dense(kFine), {kFine.Index(0, 0, 0), kFine.Index(1, 0, 0)});
  samples.multiplicity = {3, 1};
  const BrdfSamples means = MeansOfFourBins(samples, 1);
  ASSERT_EQ(means.size(), 1);
  EXPECT_NEAR(means.rho[0][0], kFine.Index(1, 0, 0) / 4.0, 1e-12);
  EXPECT_EQ(means.multiplicity, std::vector<double>{4});
}

TEST(MeansOfFourBins, KeepMirroredPairsTogether) {
  const BrdfSamples samples = Dense(kFine);
  for (int stride = 2; stride <= LongestStride(kFine); ++stride) {
    const BrdfSamples means = MeansOfFourBins(samples, stride);
    const MerlGrid& grid = means.grid;
    const std::set<int> kept(means.bins.begin(), means.bins.end());
    for (const int bin : kept) {
      const int p = bin % grid.phi_d;
      EXPECT_TRUE(kept.contains(bin - p + grid.phi_d - 1 - p)) << stride << ", bin " << bin;
    }
    EXPECT_LT(means.size(), MeansOfFourBins(samples, 1).size());
  }
}

TEST(MeansOfFourBins, SaysWhatItCannotHalve) {
  const BrdfSamples odd = Dense({.theta_h = 5, .theta_d = 4, .phi_d = 6});
  EXPECT_THAT(ErrorOf([&] { MeansOfFourBins(odd, 1); }),
              IsError(ErrorKind::kUnsupported, {.key = "bins"}));
  EXPECT_THAT(ErrorOf([&] { MeansOfFourBins(Scattered(ValidSamples(RandomTable(kFine, 1))), 1); }),
              IsError(ErrorKind::kUnsupported, {.key = "bins"}));
  EXPECT_THAT(ErrorOf([&] { MeansOfFourBins(Dense(kFine), 0); }),
              IsError(ErrorKind::kRange, {.key = "stride", .value = "0"}));
  EXPECT_EQ(MeansOfFourBins(Selected(Dense(kFine), {}), 1).size(), 0);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
