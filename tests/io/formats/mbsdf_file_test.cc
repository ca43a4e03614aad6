#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/io/formats/read_as.h"
#include "tests/paths.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <typename T>
std::string Bytes(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

const std::string kMagic = "NVIDIA ARC MBSDF V1\n";
const std::string kReflection = "MBSDF_DATA_REFLECTION=\n";

// 2 x 2 x 3 cells; the value is the number of the cell, R of it, G and B of it and ten more.
std::string Colours() {
  std::vector<float> values;
  for (int cell = 0; cell < 12; ++cell) {
    for (int c = 0; c < 3; ++c) values.push_back(static_cast<float>(cell + 10 * c));
  }
  return Bytes<uint32_t>({1, 2, 3}) + Bytes(values);
}

Measurement Parse(const std::string& bytes) { return ReadAs("mbsdf", bytes, "x.mbsdf"); }
std::optional<Error> ParseError(const std::string& bytes) {
  return ErrorOf([&] { Parse(bytes); });
}

TEST(MbsdfFile, ReadsCellsAtTheirCentres) {
  for (const std::string& begin :
       {kMagic + kReflection, kMagic + "name=\"blue\"\nby=\"me\"\n" + kReflection,
        kMagic + "MBSDF_DATA=\n"}) {
    const Measurement measurement = Parse(begin + Colours());
    ASSERT_EQ(measurement.counts.valid, 12);
    // theta_in 1, theta_out 0, phi 2.
    const SphericalAngles angles = measurement.samples.directions[8];
    EXPECT_DOUBLE_EQ(RadiansToDegrees(angles.theta_i), 67.5);
    EXPECT_DOUBLE_EQ(RadiansToDegrees(angles.theta_o), 22.5);
    EXPECT_DOUBLE_EQ(RadiansToDegrees(angles.phi_o - angles.phi_i), 150);
    EXPECT_THAT(measurement.samples.rho[8], ElementsAre(8, 18, 28));
    EXPECT_NO_THROW(CheckSamples(SamplesOf(measurement)));
  }
}

TEST(MbsdfFile, TakesOneValueForAllChannelsAndLeavesOutTransmission) {
  const Measurement measurement =
      Parse(kMagic + kReflection + Bytes<uint32_t>({0, 1, 2}) + Bytes<float>({0.5F, -1.0F}) +
            "MBSDF_DATA_TRANSMISSION=\n" + Colours());
  EXPECT_EQ(measurement.counts.total, 2);
  EXPECT_EQ(measurement.counts.negative, 1);
  EXPECT_THAT(measurement.samples.rho[0], ElementsAre(0.5, 0.5, 0.5));
}

TEST(MbsdfFile, ErrorsSayWhatIsWrong) {
  EXPECT_THAT(ParseError("hi\n"),
              IsError(ErrorKind::kFormat, {.file = "x.mbsdf", .key = "content"}));
  EXPECT_THAT(ParseError(kMagic + "name=\"x\""), IsError(ErrorKind::kMissing, {.key = "data"}));
  EXPECT_THAT(ParseError(kMagic + "MBSDF_DATA_TRANSMISSION=\n" + Colours()),
              IsError(ErrorKind::kUnsupported, {.key = "data"}));
  const std::string whole = kMagic + kReflection + Colours();
  EXPECT_THAT(ParseError(whole.substr(0, kMagic.size() + kReflection.size() + 5)),
              IsError(ErrorKind::kFormat, {.key = "header"}));
  EXPECT_THAT(ParseError(whole.substr(0, whole.size() - 1)),
              IsError(ErrorKind::kFormat, {.key = "bytes", .value = "143"}));
  EXPECT_THAT(ParseError(whole + "abc"),
              IsError(ErrorKind::kFormat, {.key = "bytes", .value = "3"}));
  EXPECT_THAT(ParseError(kMagic + kReflection + Bytes<uint32_t>({2, 1, 1})),
              IsError(ErrorKind::kUnknown, {.key = "type", .value = "2"}));
  EXPECT_THAT(ParseError(kMagic + kReflection + Bytes<uint32_t>({1, 0, 1})),
              IsError(ErrorKind::kRange, {.key = "grid"}));
  EXPECT_THAT(ParseError(kMagic + kReflection + Bytes<uint32_t>({1, 65536, 65536})),
              IsError(ErrorKind::kRange, {.key = "grid"}));
}

// Counted by another program.
TEST(MbsdfFile, ReadsPublishedMeasurements) {
  const std::string folder = MeasuredData("mbsdf/");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  const std::string path = folder + "carpaint_blue.mbsdf";
  const Measurement blue = LoadMeasurement(path, {.min_theta_d_deg = 0, .extrapolated = true});
  EXPECT_FALSE(blue.table);
  EXPECT_EQ(blue.counts.total, 45 * 45 * 90);
  EXPECT_NEAR(blue.counts.negative / 182250.0, 0.4082139917695473, 1e-12);
  EXPECT_EQ(blue.counts.valid + blue.counts.negative, blue.counts.total);
  EXPECT_EQ(MaxAngleDegrees(blue), 89);
  EXPECT_NO_THROW(CheckSamples(SamplesOf(blue)));
  const PairError error = ReciprocityError(blue);
  EXPECT_EQ(error.pairs, 39879);
  EXPECT_NEAR(error.median, 0.31699, 1e-5);
  EXPECT_NEAR(error.percentile_95, 1.6071, 1e-3);
  // The brightest direction of theta_in = 41 degrees is the mirror's.
  int brightest = 0;
  for (int j = 0; j < blue.samples.size(); ++j) {
    if (std::abs(blue.samples.directions[j].theta_i - DegreesToRadians(41)) > 1e-9) continue;
    if (blue.samples.rho[j][1] > blue.samples.rho[brightest][1]) brightest = j;
  }
  EXPECT_LT(blue.samples.angles[brightest].theta_h, DegreesToRadians(4));

  // The detector stood in its own light, and a third of the file was filled in.
  const Measurement lit = LoadMeasurement(path, {.extrapolated = true});
  EXPECT_EQ(lit.counts.valid, 94767);
  EXPECT_EQ(lit.counts.below_min_theta_d, blue.counts.valid - 94767);
  EXPECT_THAT(lit.notes, ElementsAre(HasSubstr("below 14 deg")));
  const Measurement measured = LoadMeasurement(path);
  EXPECT_EQ(measured.counts.extrapolated, lit.counts.valid - measured.counts.valid);
  EXPECT_THAT(measured.notes, ElementsAre(HasSubstr("below 14 deg"),
                                          HasSubstr("11 of 45 theta_i and 4 of 45 theta_o")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
