#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

Measurement Parse(const std::string& text) { return ReadAs("ssdd", text, "x.ssdd"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

const std::string kKeys =
    "VERSION 0.2\n# made up\nSOFTWARE none\n\nDATA_TYPE brdf\nCOLOR_MODEL rgb\n";
const std::string kLists = "PARAM0_LIST 10 45\nPARAM2_LIST 0 30 60\nPARAM3_LIST 0 70 180\n";

// The values of the known truth, which `angles` places.
template <typename Angles>
std::string RowsBy(const Angles& angles) {
  std::string text;
  for (const double c : {0, 70, 180}) {
    for (const double b : {0, 30, 60}) {
      for (const double a : {10, 45}) {
        const SphericalAngles at =
            angles(DegreesToRadians(a), DegreesToRadians(b), DegreesToRadians(c));
        const Rgb rho =
            at.theta_o < kPi / 2
                ? TrueValue(RadiansToDegrees(at.theta_i), RadiansToDegrees(at.phi_i),
                            RadiansToDegrees(at.theta_o), RadiansToDegrees(at.phi_o), false)
                : Rgb{};
        text += Text(rho[0]) + " " + Text(rho[1]) + "\t" + Text(rho[2]) + "\n";
      }
    }
  }
  return text;
}

std::string SphericalRows() {
  return RowsBy([](double a, double b, double c) { return SphericalAngles{a, 0, b, c}; });
}

TEST(SsddFile, ReadsTheFirstListFastest) {
  const std::string text = kKeys + "PARAM_TYPE spherical_coordinate_system\n" + kLists +
                           "SOURCE_TYPE measured\nDATA ascii\n" + SphericalRows();
  const Measurement measurement = Source("any", text).Read();
  EXPECT_EQ(measurement.kind, "SSDD file of scattered samples");
  EXPECT_EQ(measurement.counts.total, 18);
  EXPECT_FALSE(measurement.anisotropic);
  ExpectTruth(measurement, /*grey=*/false);
  EXPECT_NEAR(measurement.samples.directions[1].theta_i, DegreesToRadians(45), 1e-12);
}

TEST(SsddFile, ReadsAnglesFromTheMirrorDirection) {
  // At an angle b from the mirror direction in the plane of incidence, away from the normal where
  // the azimuth c is 180 degrees.
  const auto angles = [](double a, double b, double c) {
    const Direction mirror = {-std::sin(a), 0, std::cos(a)};
    const Direction along = {std::cos(a), 0, std::sin(a)}, across = {0, 1, 0};
    Direction wo;
    for (int k = 0; k < 3; ++k) {
      wo[k] = std::cos(b) * mirror[k] +
              std::sin(b) * (std::cos(c) * along[k] + std::sin(c) * across[k]);
    }
    const PolarAngles out = ToPolarAngles(wo);
    return SphericalAngles{a, 0, out.theta, out.phi};
  };
  const Measurement measurement = Parse(kKeys + "PARAM_TYPE specular_coordinate_system\n" + kLists +
                                        "PARAM4_LIST 0 0\n" + "DATA ascii\n" + RowsBy(angles));
  EXPECT_EQ(measurement.counts.total, 18);
  EXPECT_EQ(measurement.counts.below_surface, 1);  // 45 + 60 degrees
  ExpectTruth(measurement, /*grey=*/false);
}

TEST(SsddFile, ReadsHalfVectors) {
  const auto angles = [](double a, double b, double c) {
    return ToSphericalAngles(ToDirections(HalfDiffAngles{.theta_h = a, .theta_d = b, .phi_d = c}));
  };
  const Measurement measurement = Parse(kKeys + "PARAM_TYPE half_difference_coordinate_system\n" +
                                        kLists + "DATA ascii\n" + RowsBy(angles));
  EXPECT_GE(measurement.counts.valid, 14);
  ExpectTruth(measurement, /*grey=*/false);
}

TEST(SsddFile, ReadsBinaryNumbersAndColourModels) {
  const std::string keys =
      "VERSION 0.2\nDATA_TYPE btdf\nCOLOR_MODEL monochrome\nPARAM_TYPE "
      "spherical_coordinate_system\nPARAM0_LIST 0\nPARAM2_LIST 0\nPARAM3_LIST 0\nDATA ascii\n7\n"
      "DATA_TYPE brdf\nPARAM_TYPE spherical_coordinate_system\n";
  const std::string lists = "PARAM0_LIST 0 20\nPARAM2_LIST 10\nPARAM3_LIST 0\n";
  std::string binary = keys + "COLOR_MODEL monochrome\n" + lists + "DATA binary\n";
  for (const float value : {0.25F, 0.5F}) {
    binary.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  const Measurement grey = Source("any", binary).Read();
  ASSERT_EQ(grey.samples.size(), 2);
  EXPECT_EQ(grey.samples.rho[1], (Rgb{0.5, 0.5, 0.5}));
  EXPECT_THAT(ParseError(binary.substr(0, binary.size() - 1)),
              IsError(ErrorKind::kMismatch, {.key = "DATA"}));

  const Measurement spectral =
      Parse(keys + "COLOR_MODEL spectrum\nWAVELENGTH_LIST 450 500 550 600 650\n" + lists +
            "DATA ascii\n0.1 0.2 0.3 0.3 0.2\n0.1 0.2 0.3 0.3 0.2\n");
  EXPECT_EQ(spectral.bands, 5);
  const Measurement white = Parse(keys + "COLOR_MODEL xyz\n" + lists +
                                  "DATA ascii\n0.0950 0.1 0.1089\n0.0950 0.1 0.1089\n");
  EXPECT_NEAR(white.samples.rho[0][0], 0.1, 1e-3);
  EXPECT_NEAR(white.samples.rho[0][2], 0.1, 1e-3);
}

TEST(SsddFile, ErrorsSayWhereAndWhatIsExpected) {
  const std::string spherical = "PARAM_TYPE spherical_coordinate_system\n";
  const std::string head = kKeys + spherical + kLists + "DATA ascii\n", rows = SphericalRows();
  EXPECT_THAT(ParseError(kKeys), IsError(ErrorKind::kMissing, {.file = "x.ssdd"}));
  EXPECT_THAT(ParseError(kKeys + kLists + "DATA ascii\n" + rows),
              IsError(ErrorKind::kMissing, {.line = 10, .key = "PARAM_TYPE"}));
  EXPECT_THAT(ParseError(kKeys + spherical + "PARAM0_LIST 0\nDATA ascii\n1 1 1\n"),
              IsError(ErrorKind::kMissing, {.key = "PARAM2_LIST"}));
  EXPECT_THAT(ParseError(kKeys + "PARAM_TYPE other\n"),
              IsError(ErrorKind::kUnknown, {.line = 7, .key = "PARAM_TYPE", .value = "other"}));
  EXPECT_THAT(ParseError(kKeys + "COLOR_MODEL other\n"),
              IsError(ErrorKind::kUnknown, {.key = "COLOR_MODEL"}));
  EXPECT_THAT(ParseError(kKeys + spherical + kLists + "DATA other\n"),
              IsError(ErrorKind::kUnknown, {.key = "DATA"}));
  EXPECT_THAT(ParseError(kKeys + "PARAM4_LIST 0 -5\n"),
              IsError(ErrorKind::kUnsupported, {.key = "PARAM4_LIST"}));
  EXPECT_THAT(ParseError(kKeys + "PARAM0_LIST 0 x\n"),
              IsError(ErrorKind::kFormat, {.line = 7, .key = "PARAM0_LIST", .value = "x"}));
  EXPECT_THAT(ParseError(head + rows.substr(0, rows.size() / 2)), testing::Optional(testing::_));
  EXPECT_THAT(ParseError(head + "1 2\n"), IsError(ErrorKind::kFormat, {.line = 12}));
  EXPECT_THAT(ParseError("VERSION 0.2\nDATA_TYPE btdf\nCOLOR_MODEL rgb\n"),
              IsError(ErrorKind::kMissing, {.key = "DATA_TYPE"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
