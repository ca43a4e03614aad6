#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "tests/error_of.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

const std::string kHead = "type bsdf_data\nformat angles=deg bsdf=value scale=1\n";

// The mirror direction has the azimuth of the incidence.
std::string Block(double theta_i, double phi_i, bool anisotropic = false) {
  std::string text = Text(theta_i) + "\t" + Text(phi_i) + "\n";
  for (const double theta : {-30.0, 0.0, 20.0, 60.0}) {
    for (const double phi : {0.0, 50.0, 180.0}) {
      const Rgb rho = TrueValue(theta_i, phi_i + 180, theta, phi, anisotropic);
      const Rgb beyond = TrueValue(theta_i, phi_i + 180, -theta, phi + 180, anisotropic);
      text += Text(theta) + "\t" + Text(phi) + "\t" + Text((theta < 0 ? beyond : rho)[1]) + "\n";
    }
  }
  return text;
}

Measurement Parse(const std::string& text) { return ReadAs("fred", text, "x.txt"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

TEST(FredFile, ReadsBackAKnownMaterial) {
  const Measurement measurement = Source("any", kHead + Block(10, 0) + Block(45, 0)).Read();
  EXPECT_EQ(measurement.kind, "FRED file of scattered samples");
  EXPECT_EQ(measurement.counts.total, 24);
  EXPECT_FALSE(measurement.anisotropic);
  ExpectTruth(measurement, /*grey=*/true);
}

TEST(FredFile, AzimuthsOfIncidenceMakeItAnisotropic) {
  const Measurement measurement = Parse(kHead + Block(40, 0, true) + Block(40, 90, true));
  EXPECT_TRUE(measurement.anisotropic);
  ExpectTruth(measurement, /*grey=*/true, /*anisotropic=*/true);
}

TEST(FredFile, RadiansAndScale) {
  const Measurement measurement =
      Parse("type bsdf_data\nformat angles=rad scale=2\n0.5 0\n0.25 0 0.1\n");
  ASSERT_EQ(measurement.samples.size(), 1);
  EXPECT_DOUBLE_EQ(measurement.samples.directions[0].theta_i, 0.5);
  EXPECT_DOUBLE_EQ(measurement.samples.rho[0][0], 0.2);
}

TEST(FredFile, ErrorsSayWhereAndWhatIsExpected) {
  EXPECT_THAT(ParseError(""), IsError(ErrorKind::kMissing, {.key = "incidence"}));
  EXPECT_THAT(ParseError("10 0\n"),
              IsError(ErrorKind::kMissing, {.file = "x.txt", .line = 1, .key = "type"}));
  EXPECT_THAT(ParseError("type other\n"), IsError(ErrorKind::kFormat, {.line = 1, .key = "type"}));
  EXPECT_THAT(ParseError("type bsdf_data\nformat bsdf=log\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "format"}));
  EXPECT_THAT(ParseError("type bsdf_data\nformat scale=0\n"),
              IsError(ErrorKind::kRange, {.line = 2, .key = "scale"}));
  EXPECT_THAT(ParseError(kHead + "0 0 0.03\n"),
              IsError(ErrorKind::kMissing, {.line = 3, .key = "incidence"}));
  EXPECT_THAT(ParseError(kHead + "10 0\n1\n"),
              IsError(ErrorKind::kFormat, {.line = 4, .key = "columns", .value = "1"}));
  EXPECT_THAT(ParseError(kHead + "10 x\n"),
              IsError(ErrorKind::kFormat, {.line = 3, .key = "phi", .value = "x"}));
  EXPECT_THAT(ParseError(kHead + "10 nan\n"),
              IsError(ErrorKind::kRange, {.line = 3, .key = "phi", .value = "nan"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
