#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "core/files/file.h"
#include "tests/error_of.h"
#include "tests/io/formats/read_as.h"
#include "tests/test_directory.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;

const std::string kHeader = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";

Measurement Parse(const std::string& text) { return ReadAs("csv", text, "x.csv"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

// phi_d is the same modulo 180 degrees, and means nothing where the directions lie together.
void ExpectSameSamples(const BrdfSamples& a, const BrdfSamples& b) {
  ASSERT_EQ(a.size(), b.size());
  for (int j = 0; j < a.size(); ++j) {
    const HalfDiffAngles x = a.Angles(j), y = b.Angles(j);
    ASSERT_NEAR(x.theta_h, y.theta_h, 1e-12) << j;
    ASSERT_NEAR(x.theta_d, y.theta_d, 1e-12) << j;
    ASSERT_NEAR(std::remainder(x.phi_d - y.phi_d, kPi), 0, 1e-10) << j;
    ASSERT_EQ(a.rho[j], b.rho[j]) << j;
  }
}

TEST(CsvFile, HoldsTheSamplesOfATable) {
  const TestDirectory directory;
  const Measurement felt = LoadMeasurement("synth:felt", {.noise = 0.1, .max_angle_deg = 30});
  const std::string path = directory.Path("felt.csv");
  const std::string written = WriteMeasurement(felt, path);
  const Measurement read = LoadMeasurement(path);
  EXPECT_TRUE(read.table);
  EXPECT_EQ(written, "CSV, " + std::to_string(CountsOf(read).valid) + " samples");
  EXPECT_EQ(CountsOf(read).valid, CountsOf(felt).valid);
  ExpectSameSamples(SamplesOf(read), ValidSamples(*felt.table));
  EXPECT_NO_THROW(CheckSamples(SamplesOf(read)));
  EXPECT_LE(MaxAngleDegrees(read), 30);
  EXPECT_GT(MaxAngleDegrees(read), 29.9);
}

TEST(CsvFile, HoldsScatteredSamples) {
  const TestDirectory directory;
  const Measurement one = Parse(kHeader +
                                "10,0,60.5,123.456,0.1,2e-5,3\n"
                                "60.5,123.456,10,0,1,0,1e-300\n"
                                "0,0,0,0,1,1,1\n"
                                "45,90,45,-90,0.1,0.2,0.30000000000000004\n");
  EXPECT_EQ(one.counts.valid, 4);
  EXPECT_EQ(WriteMeasurement(one, directory.Path("y.csv")), "CSV, 4 samples");
  const Measurement two = LoadMeasurement(directory.Path("y.csv"));
  ExpectSameSamples(one.samples, two.samples);
  EXPECT_THAT(ReadFile(directory.Path("y.csv")), testing::HasSubstr("\n10,0,60.5,123.456,0.1,"));
  // The order of the directions is kept, which half and difference angles do not tell.
  EXPECT_NEAR(two.samples.directions[1].theta_i, DegreesToRadians(60.5), 1e-15);
  EXPECT_NEAR(two.samples.directions[1].phi_i, DegreesToRadians(123.456), 1e-15);
}

TEST(CsvFile, HoldsAnisotropicSamples) {
  const TestDirectory directory;
  const Measurement silk = LoadMeasurement("synth:shot_silk@3x8", {.noise = 0.1});
  WriteMeasurement(silk, directory.Path("silk.csv"));
  const Measurement read = LoadMeasurement(directory.Path("silk.csv"));
  EXPECT_TRUE(read.anisotropic);
  ASSERT_EQ(read.samples.rho, silk.samples.rho);
  for (int j = 0; j < read.samples.size(); ++j) {
    const SphericalAngles &a = read.samples.directions[j], &b = silk.samples.directions[j];
    ASSERT_NEAR(a.theta_i, b.theta_i, 1e-15);
    ASSERT_NEAR(a.phi_i, b.phi_i, 1e-15);
    ASSERT_NEAR(a.theta_o, b.theta_o, 1e-15);
    ASSERT_NEAR(a.phi_o, b.phi_o, 1e-15);
  }
}

TEST(CsvFile, AzimuthsMatterWhereLightComesFromSeveral) {
  const auto anisotropic = [](const std::string& rows) {
    return Parse(kHeader + rows).anisotropic;
  };
  EXPECT_FALSE(anisotropic(""));
  EXPECT_FALSE(anisotropic("10,20,30,40,1,1,1\n40,-340,50,60,1,1,1\n0,77,50,60,1,1,1\n"));
  EXPECT_TRUE(anisotropic("0,0,30,40,1,1,1\n10,20,30,40,1,1,1\n40,21,50,60,1,1,1\n"));
}

TEST(CsvFile, ColumnsAreFoundByTheirNames) {
  const Measurement measurement = Parse(
      "\xEF\xBB\xBF# felt, measured on a Monday\r\n\r\n b,g,r , phi_o,theta_o,phi_i,theta_i\r\n"
      "3,2,1,180,30,0,+30 # the mirror direction\r\n");
  ASSERT_EQ(measurement.samples.size(), 1);
  EXPECT_THAT(measurement.samples.rho[0], ElementsAre(1, 2, 3));
  EXPECT_NEAR(measurement.samples.angles[0].theta_h, 0, 1e-15);
  EXPECT_NEAR(measurement.samples.angles[0].theta_d, kPi / 6, 1e-15);
}

TEST(CsvFile, CountsWhatIsNotValid) {
  const Measurement measurement = Parse(kHeader +
                                        "10,0,90,0,1,1,1\n"     // the horizon
                                        "100,0,10,0,nan,1,1\n"  // below it, whatever the value
                                        "10,0,20,0,nan,-1,1\n"  // not finite, whatever the others
                                        "10,0,20,0,1,inf,1\n"
                                        "10,0,20,0,1,1,-1e-9\n"
                                        "10,0,60,0,0,0,0\n"
                                        "70,0,10,0,1,1,1\n");
  const BinCounts counts = measurement.counts;
  EXPECT_EQ(counts.total, 7);
  EXPECT_EQ(counts.valid, 2);
  EXPECT_EQ(counts.below_surface, 2);
  EXPECT_EQ(counts.non_finite, 2);
  EXPECT_EQ(counts.negative, 1);
  EXPECT_EQ(MaxAngleDegrees(measurement), 70);

  Measurement limited = measurement;
  DecideMeasured({.max_angle_deg = 60}, &limited);  // 60 itself is within
  EXPECT_EQ(limited.counts.valid, 1);
  EXPECT_EQ(limited.counts.beyond_max_angle, 1);
  EXPECT_EQ(limited.samples.size(), 1);
  EXPECT_EQ(MaxAngleDegrees(limited), 60);
  DecideMeasured({.max_angle_deg = 59}, &limited);
  EXPECT_EQ(limited.counts.beyond_max_angle, 2);
  EXPECT_THAT(ErrorOf([&] { SamplesOf(limited); }),
              IsError(ErrorKind::kData, {.file = "x.csv", .key = "samples", .value = "0"}));
}

TEST(CsvFile, FindsReciprocalPairs) {
  Measurement measurement = Parse(kHeader +
                                  "20,0,50,30,1,1,1\n"
                                  "20,0,50,-30,3,3,3\n"  // the mirror image: mean 2
                                  "50,10,20,40,4,4,4\n"  // swapped, turned by 10 degrees
                                  "20,0,50,31,9,9,9\n"   // no partner
                                  "40,0,40,90,1,1,1\n"   // its own
                                  "0,0,30,0,1,1,1\n"
                                  "30,77,0,0,1,1,1\n");  // phi means nothing here
  measurement.anisotropic = false;                       // known to be isotropic
  const PairError error = ReciprocityError(measurement);
  EXPECT_EQ(error.pairs, 2);
  EXPECT_DOUBLE_EQ(error.median, 0);
  EXPECT_DOUBLE_EQ(error.percentile_95, 2.0 / 3);
}

TEST(CsvFile, WhereAzimuthsMatterReciprocityIsThatOfTheSameDirections) {
  const Measurement measurement = Parse(kHeader +
                                        "20,10,50,40,1,1,1\n"
                                        "50,40,20,-350,1,1,1\n"  // the same, swapped
                                        "50,0,20,30,9,9,9\n"     // turned
                                        "0,5,30,10,1,1,1\n"
                                        "30,10,0,90,3,3,3\n");  // phi means nothing here
  ASSERT_TRUE(measurement.anisotropic);
  const PairError error = ReciprocityError(measurement);
  EXPECT_EQ(error.pairs, 2);
  EXPECT_DOUBLE_EQ(error.median, 0);
  EXPECT_DOUBLE_EQ(error.percentile_95, 1);
}

TEST(CsvFile, ErrorsSayWhereAndWhatIsExpected) {
  EXPECT_THAT(ParseError("\n# nothing\n"),
              IsError(ErrorKind::kFormat, {.file = "x.csv", .key = "content", .value = "empty"}));
  EXPECT_THAT(ParseError("theta_i,phi_i,theta_o,r,g,b\n"),
              IsError(ErrorKind::kMissing, {.file = "x.csv", .line = 1, .key = "phi_o"}));
  EXPECT_THAT(ParseError("theta_i,phi_i,theta_o,phi_o,r,g,b,b\n"),
              IsError(ErrorKind::kConflict, {.line = 1, .key = "b", .value = "b"}));
  EXPECT_THAT(
      ParseError(kHeader + "# a comment\n1,2,3\n"),
      IsError(ErrorKind::kFormat, {.file = "x.csv", .line = 3, .key = "columns", .value = "3"}));
  EXPECT_THAT(
      ParseError(kHeader + "1,2,3,4,5,6,7\n1,2,3,abc,5,6,7\n"),
      IsError(ErrorKind::kFormat, {.file = "x.csv", .line = 3, .key = "phi_o", .value = "abc"}));
  EXPECT_THAT(ParseError(kHeader + "1,2,3,4,5,,7\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "g"}));
  EXPECT_THAT(ParseError(kHeader + "1,2,3,4,5 6,6,7\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "r", .value = "5 6"}));
  EXPECT_THAT(
      ParseError(kHeader + "-190,2,3,4,5,6,7\n"),
      IsError(ErrorKind::kRange, {.file = "x.csv", .line = 2, .key = "theta_i", .value = "-190"}));
  EXPECT_THAT(ParseError(kHeader + "10,2,3,400,5,6,7\n"),
              IsError(ErrorKind::kRange, {.line = 2, .key = "phi_o", .value = "400"}));
  EXPECT_THAT(ParseError(kHeader + "nan,2,3,4,5,6,7\n"),
              IsError(ErrorKind::kRange, {.line = 2, .key = "theta_i", .value = "nan"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
