#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "model/measurement/bad_readings.h"
#include "tests/test_util.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/corruption.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr MerlGrid kGrid{.theta_h = 20, .theta_d = 16, .phi_d = 24};

// All data, outliers too.
Measurement Corrupted(const std::string& source, const std::string& corrupt) {
  SourceOptions options;
  options.corrupt = corrupt;
  options.outliers = true;
  return LoadMeasurement(source, options);
}

// A highlight that falls by up to `fall` times from one theta_h to the next.
BrdfTable Highlight(double fall) {
  BrdfTable table = MakeInvalidTable("test", kGrid);
  const std::vector<bool> above = BinsAboveSurface(kGrid);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    if (!above[bin]) continue;
    const int h = bin / (kGrid.theta_d * kGrid.phi_d);
    for (int c = 0; c < kChannels; ++c) table.SetValue(c, bin, 0.1 + std::pow(fall, 6 - h));
  }
  return table;
}

// The bins of the outliers.
std::vector<int> BinsOf(const BrdfTable& table, int num_threads) {
  const BrdfSamples samples = ValidSamples(table);
  std::vector<int> bins;
  for (const Outlier& outlier : FindOutliers(samples, num_threads)) {
    bins.push_back(samples.bins[outlier.sample]);
  }
  return bins;
}

double ShareOfOutliers(const BrdfTable& table) {
  return static_cast<double>(BinsOf(table, 1).size()) / CountBins(table).valid;
}

void Multiply(double factor, int bin, BrdfTable* table) {
  for (auto& plane : table->stored) plane[bin] *= factor;
}

TEST(Outliers, SmoothDataHaveNone) {
  for (const char* const name : {"plastic", "chrome", "felt", "foam", "rubber", "car-paint"}) {
    const std::string source = "synth:" + std::string(name) + "@90x30x60";
    const Measurement measurement = LoadMeasurement(source);
    EXPECT_EQ(CountsOf(measurement).negative, 0) << name;  // a few at the horizon stay
    EXPECT_THAT(measurement.notes, IsEmpty()) << name;
  }
  EXPECT_THAT(BinsOf(Highlight(50), 1), IsEmpty());
  EXPECT_LE(ShareOfOutliers(TableOf(Corrupted("synth:plastic@40x40x40", "noise:0.2"))), 1e-4);
}

TEST(Outliers, LessIsEnoughWhereTheOthersAgree) {
  // The share of the spikes that are found, and the share of what is found that is none.
  const auto found = [](const std::string& source, const std::string& spikes) {
    const BrdfTable clean = TableOf(Corrupted(source, ""));
    const BrdfTable table = TableOf(Corrupted(source, spikes));
    const std::vector<int> bins = BinsOf(table, 2);
    int spiked = 0, right = 0;
    for (int bin = 0; bin < table.grid.size(); ++bin) {
      if (table.stored[0][bin] == clean.stored[0][bin]) continue;
      ++spiked;
      right += std::ranges::binary_search(bins, bin) ? 1 : 0;
    }
    return std::pair(1.0 * right / spiked, 1 - 1.0 * right / static_cast<double>(bins.size()));
  };
  for (const char* const spikes : {"spikes:0.2", "spikes:0.33", "spikes:3", "spikes:5"}) {
    const auto [matt, wrong] = found("synth:felt@45x30x60", spikes);
    EXPECT_GT(matt, 0.9) << spikes;
    EXPECT_LT(wrong, 0.02) << spikes;
    // Beside a highlight of few bins the others do not agree.
    EXPECT_GT(found("synth:plastic@45x30x60", spikes).first, 0.5) << spikes;
  }
  EXPECT_LE(ShareOfOutliers(TableOf(Corrupted("synth:plastic@45x30x60", "noise:0.5"))), 1e-3);
}

TEST(Outliers, SingleBinsAreFoundEverywhere) {
  const BrdfTable smooth = Highlight(2);
  const std::vector<bool> valid = ValidBins(smooth);
  for (int bin = 0; bin < kGrid.size(); bin += 23) {
    if (!valid[bin]) continue;
    for (const double factor : {0.0, 1 / 40.0, 40.0}) {
      BrdfTable table = smooth;
      Multiply(factor, bin, &table);
      EXPECT_THAT(BinsOf(table, 1), ElementsAre(bin)) << factor;
    }
    BrdfTable table = smooth;
    Multiply(2, bin, &table);
    EXPECT_THAT(BinsOf(table, 1), IsEmpty());
  }
}

TEST(Outliers, ADarkRingIsNone) {
  BrdfTable table = Highlight(1);
  const std::vector<bool> valid = ValidBins(table);
  const auto multiply = [&](double factor) {
    for (int d = 0; d < kGrid.theta_d / 2; ++d) {
      for (int p = 0; p < kGrid.phi_d; ++p) {
        const int bin = kGrid.Index(9, d, p);
        if (valid[bin]) Multiply(factor, bin, &table);
      }
    }
  };
  multiply(1e-3);
  EXPECT_THAT(BinsOf(table, 1), IsEmpty());
}

TEST(Outliers, AmongFewBinsToo) {
  const std::string source = "synth:felt@60x60x60";
  const BrdfTable clean = TableOf(Corrupted(source, "gaps:0.9"));
  const BrdfTable zeros = TableOf(Corrupted(source, "gaps:0.9,zeros:0.05"));
  EXPECT_LE(ShareOfOutliers(clean), 1e-3);
  int all = 0;
  for (int bin = 0; bin < clean.grid.size(); ++bin) {
    all += zeros.stored[0][bin] == 0 && clean.stored[0][bin] > 0 ? 1 : 0;
  }
  int zeros_found = 0;
  for (const int bin : BinsOf(zeros, 1)) zeros_found += zeros.stored[0][bin] == 0 ? 1 : 0;
  EXPECT_GE(zeros_found, 0.9 * all);
}

TEST(Outliers, BlackAndEmptyTablesHaveNone) {
  BrdfTable table = Highlight(2);
  for (auto& plane : table.stored) std::ranges::fill(plane, 0.0);
  EXPECT_THAT(BinsOf(table, 1), IsEmpty());
  EXPECT_THAT(FindOutliers(BrdfSamples{"test", kGrid, {}, {}, {}}, 1), IsEmpty());
}

TEST(Outliers, TheSameForAnyThreads) {
  const BrdfTable table = TableOf(Corrupted("synth:plastic@40x40x40", "zeros:0.05"));
  const std::vector<int> found = BinsOf(table, 1);
  EXPECT_FALSE(found.empty());
  EXPECT_EQ(BinsOf(table, 3), found);
}

TEST(Outliers, AreLeftOutOfASourceAndTold) {
  const std::string source = "synth:plastic@40x40x40";
  SourceOptions options;
  options.corrupt = "outliers:0.05";
  const Measurement left = LoadMeasurement(source, options);
  const BinCounts clean = CountsOf(LoadMeasurement(source)), counts = CountsOf(left);
  EXPECT_NEAR(counts.valid, 0.95 * clean.valid, 0.01 * clean.valid);
  EXPECT_EQ(counts.negative, clean.valid - counts.valid);
  ASSERT_EQ(left.notes.size(), 1);
  EXPECT_THAT(left.notes.front(), HasSubstr("--outliers takes them"));
  options.outliers = true;
  const Measurement all = LoadMeasurement(source, options);
  EXPECT_EQ(CountsOf(all).valid, clean.valid);
  EXPECT_THAT(all.notes, IsEmpty());
}

TEST(Outliers, ScatteredSamplesHaveSome) {
  const Measurement few = Corrupted("synth:plastic@60x60x60", "gaps:0.5");
  const BrdfSamples on_grid = ValidSamples(*few.table);
  SampleCollector collector("test", "scattered samples");
  for (int j = 0; j < on_grid.size(); ++j) {
    const DirectionPair pair = ToDirections(on_grid.Angles(j));
    collector.Add(ToSphericalAngles(pair), j % 20 == 0 ? Rgb{} : on_grid.rho[j]);
  }
  Measurement measurement = collector.Take();
  const int all = measurement.counts.valid;
  LeaveOutOutliers(2, &measurement);
  EXPECT_NEAR(measurement.counts.valid, 0.95 * all, 0.002 * all);
  EXPECT_EQ(measurement.counts.valid, measurement.samples.size());
  EXPECT_EQ(measurement.counts.negative, all - measurement.counts.valid);
  EXPECT_LE(std::ranges::count(measurement.samples.rho, Rgb{}), 5);  // at the horizon
  EXPECT_THAT(measurement.notes, testing::SizeIs(1));
}

TEST(Outliers, WhereAzimuthsMatterOnlyNothingIsOne) {
  const std::string source = "synth:aniso_ggx_steel@6x24";
  const int all = CountsOf(LoadMeasurement(source)).valid;
  EXPECT_EQ(all, 6 * 24 * 6 * 24);
  const auto left_of = [&](const std::string& corrupt) {
    Measurement measurement = Corrupted(source, corrupt);
    LeaveOutOutliers(2, &measurement);
    return measurement;
  };
  EXPECT_EQ(CountsOf(left_of("outliers:0.05")).valid, all);
  const Measurement left = left_of("zeros:0.05");
  EXPECT_NEAR(CountsOf(left).valid, 0.95 * all, 0.02 * all);
  // Zeros stay only where both values of a reciprocal pair are 0.
  EXPECT_LE(std::ranges::count(left.samples.rho, Rgb{}), 1.5 * 0.05 * 0.05 * all);
  // Velvet reflects nothing from some directions, into others and back.
  Measurement velvet = LoadMeasurement("synth:velvet@6x24");
  const int of_velvet = CountsOf(velvet).valid;
  EXPECT_GT(std::ranges::count(velvet.samples.rho, Rgb{}), 10);
  LeaveOutOutliers(2, &velvet);
  EXPECT_EQ(CountsOf(velvet).valid, of_velvet);
}

TEST(Outliers, TheirLightIsWhatTheyAreOffBy) {
  const BrdfSamples smooth = ValidSamples(Highlight(1));
  for (const double factor : {0.0, 100.0}) {
    BrdfSamples samples = smooth;
    double off = 0, all = 0;
    for (int j = 0; j < samples.size(); ++j) {
      const Cosines cosines = samples.CosinesOf(j);
      const double light = samples.SolidAngle(j) * cosines.i * cosines.o * Mean(samples.rho[j]);
      all += light;
      if (j % 200 != 100) continue;
      for (double& x : samples.rho[j]) x *= factor;
      off += light * std::abs(factor - 1);
    }
    const std::vector<Outlier> outliers = FindOutliers(samples, 1);
    for (const Outlier& outlier : outliers) {
      EXPECT_EQ(outlier.sample % 200, 100);
      EXPECT_NEAR(outlier.median, Mean(smooth.rho[outlier.sample]), 1e-12);
    }
    EXPECT_NEAR(LightOf(outliers, samples), off / all, 1e-9 * off / all);
  }
  EXPECT_EQ(LightOf({}, smooth), 0);
}

TEST(Outliers, FewAndDarkOnesStay) {
  const Measurement smooth = LoadMeasurement("synth:plastic@40x40x40");
  const BrdfSamples samples = SamplesOf(smooth);
  // Sample indices by reflected light, ascending.
  std::vector<int> by_light(samples.size());
  std::iota(by_light.begin(), by_light.end(), 0);
  std::ranges::stable_sort(by_light, std::less(), [&](int j) {
    const Cosines cosines = samples.CosinesOf(j);
    return samples.SolidAngle(j) * cosines.i * cosines.o * Mean(samples.rho[j]);
  });
  const auto left_out = [&](int first, int count, int step) {
    Measurement measurement = smooth;
    for (int k = first; k < first + count * step; k += step) {
      Multiply(0, samples.bins[by_light[k]], &*measurement.table);
    }
    LeaveOutOutliers(1, &measurement);
    EXPECT_EQ(measurement.notes.empty(), CountsOf(measurement).negative == 0);
    return CountsOf(measurement).negative;
  };
  const int last = samples.size() - 1;
  EXPECT_EQ(left_out(last - 900, 9, 100), 0);     // few
  EXPECT_GE(left_out(last - 3000, 30, 100), 20);  // bright
  EXPECT_EQ(left_out(100, 12, 10), 0);            // dark
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
