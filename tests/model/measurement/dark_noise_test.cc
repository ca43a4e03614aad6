#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/quantile.h"
#include "model/measurement/bad_readings.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kSource = "synth:copper@30x30x60";

// All as it is read.
BrdfTable Corrupted(const std::string& source, const std::string& corrupt) {
  SourceOptions options;
  options.corrupt = corrupt;
  options.outliers = options.dark_noise = true;
  return LoadTable(source, options);
}

bool IsNoisy(const BrdfTable& table) {
  bool noisy = false;
  for (int c = 0; c < kChannels; ++c) noisy = noisy || DarkNoiseOf(table, c).IsThere();
  return noisy;
}

double MedianSignal(const BrdfTable& table) {
  const BrdfSamples samples = ValidSamples(table);
  std::vector<double> signals;
  for (int j = 0; j < samples.size(); ++j) {
    signals.push_back(Mean(samples.rho[j]) * samples.CosinesOf(j).i);
  }
  return Quantile(&signals, 0.5);
}

TEST(DarkNoise, IsNoneOfSmoothTables) {
  for (const char* const name : {"plastic", "chrome", "felt", "copper", "rubber", "car-paint"}) {
    for (const char* const grid : {"@8x8x16", "@16x16x20", "@30x30x60", "@90x30x60"}) {
      EXPECT_FALSE(IsNoisy(Corrupted(std::string("synth:") + name + grid, ""))) << name << grid;
    }
  }
}

TEST(DarkNoise, IsToldFromWhatIsInProportionToTheSignal) {
  for (const char* const corrupt :
       {"noise:0.05", "noise:0.5", "zeros:0.05", "outliers:0.05", "spikes:3", "quantize:8",
        "quantize:12", "brackets:8", "clip:0.05", "stray:0.1", "gaps:0.9"}) {
    EXPECT_FALSE(IsNoisy(Corrupted(kSource, corrupt))) << corrupt;
  }
  for (const char* const corrupt :
       {"dark:0.1", "dark:1", "photons:1e4", "dark:0.1,zeros:0.05", "dark:0.1,outliers:0.05"}) {
    EXPECT_TRUE(IsNoisy(Corrupted(kSource, corrupt))) << corrupt;
  }
}

TEST(DarkNoise, IsMeasured) {
  const double median = MedianSignal(Corrupted(kSource, ""));
  for (const double strength : {0.03, 0.1}) {
    const BrdfTable table = Corrupted(kSource, "dark:" + std::to_string(strength));
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(DarkNoiseOf(table, c).deviation, strength * median, 0.1 * strength * median);
    }
  }
}

TEST(DarkNoise, OfWhatIsBlackOrHardlyThereIsNone) {
  for (const char* const corrupt : {"zeros:1", "gaps:0.999", "beyond:5"}) {
    BrdfTable table = Corrupted(kSource, corrupt);
    EXPECT_FALSE(IsNoisy(table)) << corrupt;
    EXPECT_EQ(SmoothDarkReadings(1, &table), 0) << corrupt;
  }
}

TEST(DarkNoise, DarkReadingsComeNearerAndBrightOnesStay) {
  const BrdfTable clean = Corrupted(kSource, "");
  const BrdfTable noisy = Corrupted(kSource, "dark:0.1,gaps:0.1");
  BrdfTable smooth = noisy;
  const int count = SmoothDarkReadings(2, &smooth);
  EXPECT_GT(count, 0);
  const double median = MedianSignal(clean);
  const std::vector<bool> valid = ValidBins(noisy);
  EXPECT_EQ(ValidBins(smooth), valid);
  std::vector<double> before, after;
  for (int bin = 0; bin < clean.grid.size(); ++bin) {
    if (!valid[bin]) continue;
    const double cos_i = ToCosines(clean.grid.Center(bin)).i;
    const double signal = clean.Value(1, bin) * cos_i;
    if (signal > 2 * median) {
      EXPECT_EQ(smooth.Value(1, bin), noisy.Value(1, bin)) << bin;
    } else if (signal < 0.5 * median) {
      before.push_back(std::abs(noisy.Value(1, bin) * cos_i - signal));
      after.push_back(std::abs(smooth.Value(1, bin) * cos_i - signal));
    }
  }
  EXPECT_LT(Quantile(&after, 0.5), 0.4 * Quantile(&before, 0.5));
  EXPECT_LT(Quantile(&after, 0.95), 0.6 * Quantile(&before, 0.95));
}

TEST(DarkNoise, IsTheSameForAnyThreads) {
  BrdfTable one = Corrupted(kSource, "dark:0.1"), three = one;
  EXPECT_EQ(SmoothDarkReadings(1, &one), SmoothDarkReadings(3, &three));
  EXPECT_EQ(one.stored, three.stored);
}

TEST(DarkNoise, MeasurementsAreReadWithoutAndSaySo) {
  SourceOptions options;
  EXPECT_THAT(LoadMeasurement(kSource, options).notes, IsEmpty());
  options.corrupt = "dark:0.1";
  const Measurement smooth = LoadMeasurement(kSource, options);
  EXPECT_THAT(smooth.notes, Contains(HasSubstr("--dark_noise takes them as they are")));
  options.dark_noise = true;
  options.outliers = true;
  const Measurement as_read = LoadMeasurement(kSource, options);
  EXPECT_THAT(as_read.notes, IsEmpty());
  EXPECT_EQ(as_read.table->stored, Corrupted(kSource, "dark:0.1").stored);
  EXPECT_NE(as_read.table->stored, smooth.table->stored);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
