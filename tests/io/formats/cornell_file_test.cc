#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

#include "tests/error_of.h"
#include "tests/io/formats/read_as.h"
#include "tests/paths.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::Each;

const std::string kHeader = "# a paint\n\n# num wls\n7\n400 450 500 550\n600 650 700\n";

std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { ReadAs("cornell", text, "x.brdf"); });
}

TEST(CornellFile, ReadsSpectraInRadians) {
  const Measurement measurement = ReadAs("cornell",
                                         kHeader +
                                             "# theta i, phi i, theta s, phi_s, values\n"
                                             "0.5 0.0 0.25 3.1415926535 .2 .2 .2 .2 .2 .2 .2\n"
                                             "0.5 0.0 0.25 -3.0 0 0 0 0 0 0 -1e-5\n",
                                         "x.brdf");
  EXPECT_EQ(measurement.counts.total, 2);
  EXPECT_EQ(measurement.counts.negative, 1);
  ASSERT_EQ(measurement.samples.size(), 1);
  EXPECT_THAT(measurement.samples.rho[0], Each(testing::DoubleNear(0.2, 1e-15)));
  EXPECT_NEAR(measurement.samples.angles[0].theta_h, 0.125, 1e-9);
  EXPECT_NEAR(measurement.samples.angles[0].theta_d, 0.375, 1e-9);
}

TEST(CornellFile, BandsPicksWavelengths) {
  const std::string text = kHeader + "0.5 0 0.25 3 .1 .2 .3 .4 .5 .6 -1\n";
  const Measurement three = Source("x.brdf", text).Read({.bands = "450,550,650"});
  EXPECT_THAT(three.samples.rho, Each(Rgb{.6, .4, .2}));
  EXPECT_THAT(three.notes, Each("read as: 650, 550, 450 nm of 7 wavelengths as r, g, b"));
  EXPECT_EQ(Source("x.brdf", text).Read().samples.size(), 0);
}

TEST(CornellFile, ErrorsSayWhereAndWhatIsExpected) {
  EXPECT_THAT(ParseError("# none\n"),
              IsError(ErrorKind::kMissing, {.file = "x.brdf", .key = "wavelengths"}));
  EXPECT_THAT(ParseError("2.5\n"), IsError(ErrorKind::kFormat, {.line = 1, .key = "wavelengths"}));
  EXPECT_THAT(ParseError("3\n400 500\n"),
              IsError(ErrorKind::kFormat, {.file = "x.brdf", .key = "wavelengths", .value = "2"}));
  EXPECT_THAT(ParseError("3\n400 500\n550 600\n"),
              IsError(ErrorKind::kMismatch,
                      {.file = "x.brdf", .line = 3, .key = "wavelengths", .value = "4"}));
  EXPECT_THAT(ParseError("3\n400 x\n"),
              IsError(ErrorKind::kFormat,
                      {.file = "x.brdf", .line = 2, .key = "wavelength", .value = "x"}));
  EXPECT_THAT(
      ParseError(kHeader + "0 0 0 0 1 1 1 1 1 1\n"),
      IsError(ErrorKind::kFormat, {.file = "x.brdf", .line = 7, .key = "columns", .value = "10"}));
  EXPECT_THAT(
      ParseError(kHeader + "0 0 0 0 1 1 1 1 1 1 z\n"),
      IsError(ErrorKind::kFormat, {.file = "x.brdf", .line = 7, .key = "700 nm", .value = "z"}));
  EXPECT_THAT(ParseError(kHeader + "30 0 0 0 1 1 1 1 1 1 1\n"),
              IsError(ErrorKind::kRange, {.line = 7, .key = "theta_i", .value = "30"}));
}

// The samples and what is wrong with them, counted by another program. Blue enamel is mostly out of
// the gamut of sRGB, but its spectra are all valid.
TEST(CornellFile, ReadsPublishedMeasurements) {
  const std::string folder = MeasuredData("cornell/");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  struct Expected {
    const char* name;
    int out_of_gamut;
    Rgb mean;  // mean of the channels before clipping at 0, by numpy
  };
  for (const Expected& expected : {Expected{"garnet_red", 101, {0.101737, 0.062740, 0.063837}},
                                   Expected{"krylon_blue", 1063, {0.058535, 0.077665, 0.153173}},
                                   Expected{"mystique", 760, {0.454939, 0.472093, 0.483729}}}) {
    SCOPED_TRACE(expected.name);
    const Measurement measurement = LoadMeasurement(folder + expected.name + std::string(".brdf"));
    EXPECT_EQ(measurement.counts.total, 1439);
    EXPECT_EQ(measurement.counts.valid, 1439);
    // numpy left the spectrum out beyond 400 to 700 nm, where it is constant here.
    EXPECT_NEAR(measurement.out_of_gamut, expected.out_of_gamut, 12);
    Rgb mean{};
    for (const Rgb& rho : measurement.samples.rho) {
      for (int c = 0; c < kChannels; ++c) mean[c] += rho[c] / measurement.samples.size();
    }
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(mean[c], expected.mean[c], 0.01 * expected.mean[c] + 0.005);
    }
    EXPECT_NEAR(MaxAngleDegrees(measurement), 80, 1e-4);
    EXPECT_NO_THROW(CheckSamples(SamplesOf(measurement)));
    // The mirror direction, at the far side, is the brightest of 50 degrees.
    int brightest = -1;
    for (int j = 0; j < measurement.samples.size(); ++j) {
      if (std::abs(measurement.samples.directions[j].theta_i - DegreesToRadians(50)) > 1e-4) {
        continue;
      }
      if (brightest < 0 || measurement.samples.rho[j][1] > measurement.samples.rho[brightest][1]) {
        brightest = j;
      }
    }
    ASSERT_GE(brightest, 0);
    EXPECT_LT(measurement.samples.angles[brightest].theta_h, DegreesToRadians(8));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
