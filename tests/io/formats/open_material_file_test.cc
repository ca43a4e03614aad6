#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "tests/error_of.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

std::string Document(const std::string& rows) {
  return R"({"metadata": {"name": "plastic"}, "brdf": {"wavelengths": [9.05e-07], "lookupTable": [)" +
         rows + "]}}";
}

// The azimuth of the light is 0.
std::string Rows(const std::string& wavelength, int channel) {
  std::string text;
  for (const double theta_i : {0.0, 20.0, 60.0}) {
    for (const double theta_o : {0.0, 30.0, 60.0}) {
      for (const double phi : {0.0, 70.0, 180.0}) {
        text += (text.empty() ? "[" : ", [") + wavelength;
        for (const double degrees : {theta_i, theta_o, phi}) {
          text += ", " + Text(DegreesToRadians(degrees));
        }
        text += ", " + Text(TrueValue(theta_i, 0, theta_o, phi)[channel]) + "]";
      }
    }
  }
  return text;
}

Measurement Parse(const std::string& text) { return ReadAs("openmaterial", text, "x.xompt"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

TEST(OpenMaterialFile, OneWavelengthIsOneChannel) {
  const Measurement measurement = Source("any", Document(Rows("9.05e-07", 1))).Read();
  EXPECT_EQ(measurement.kind, "OpenMATERIAL 3D table of scattered samples");
  EXPECT_EQ(measurement.counts.valid, 27);
  EXPECT_FALSE(measurement.anisotropic);
  EXPECT_THAT(measurement.notes[0], HasSubstr("--azimuth=from_mirror takes them from"));
  ExpectTruth(measurement, /*grey=*/true);
}

TEST(OpenMaterialFile, SeveralWavelengthsAreASpectrum) {
  std::string rows;
  for (int nanometers = 400; nanometers <= 700; nanometers += 50) {
    rows += (rows.empty() ? "" : ", ") + Rows(std::to_string(nanometers) + "e-9", 1);
  }
  const Measurement measurement = Parse(Document(rows));
  EXPECT_EQ(measurement.counts.total, 27);
  ExpectTruth(measurement, /*grey=*/true);
}

TEST(OpenMaterialFile, NoValueIsAGap) {
  const Measurement measurement =
      Parse(Document("[9e-7, 0.1, 0.2, 0, null], [9e-7, 0.1, 0.3, 0, 0.25]"));
  EXPECT_EQ(measurement.counts.missing, 1);
  EXPECT_EQ(measurement.counts.valid, 1);
}

TEST(OpenMaterialFile, DecibelsAreThoseOfALambertianWhite) {
  const auto text = [](const std::string& unit) {
    return R"({"brdf": {"lookupTable": [[9e-07, 0.1, 0.2, 3, -3], [9e-07, 0.1, 0.3, 3, 0]],)"
           R"( "amplitudeUnit": ")" +
           unit + "\"}}";
  };
  const Measurement measurement = Parse(text("dB"));
  EXPECT_NEAR(measurement.samples.rho[0][1], std::pow(10, -0.3) / kPi, 1e-12);
  EXPECT_NEAR(measurement.samples.rho[1][1], 1 / kPi, 1e-12);
  EXPECT_THAT(measurement.notes[0], HasSubstr("decibels of a Lambertian white"));
  EXPECT_THAT(ParseError(text("furlong")),
              IsError(ErrorKind::kUnknown, {.key = "amplitudeUnit", .value = "furlong"}));
}

TEST(OpenMaterialFile, ErrorsSayWhereAndWhatIsExpected) {
  EXPECT_THAT(ParseError("{"),
              IsError(ErrorKind::kFormat, {.line = 1, .key = "column", .value = "2"}));
  EXPECT_THAT(ParseError("{}"), IsError(ErrorKind::kFormat, {.key = "brdf"}));
  EXPECT_THAT(ParseError(R"({"brdf": {}})"), IsError(ErrorKind::kFormat, {.key = "lookupTable"}));
  EXPECT_THAT(ParseError(Document("")), IsError(ErrorKind::kMissing, {.key = "lookupTable"}));
  const std::string good = "[9e-7, 0.1, 0.2, 0, 1], ";
  const auto second = [&](const std::string& row) { return ParseError(Document(good + row)); };
  EXPECT_THAT(second("[1]"),
              IsError(ErrorKind::kFormat, {.key = "lookupTable/2", .value = "columns"}));
  EXPECT_THAT(second("[9e-7, \"x\", 0, 0, 1]"),
              IsError(ErrorKind::kFormat, {.key = "lookupTable/2", .value = "string"}));
  EXPECT_THAT(second("[9e-7, null, 0, 0, 1]"),
              IsError(ErrorKind::kFormat, {.key = "lookupTable/2", .value = "null"}));
  EXPECT_THAT(second("[905, 0.1, 0.2, 0, 1]"),
              IsError(ErrorKind::kRange, {.key = "lookupTable/2", .value = "wavelength"}));
  EXPECT_THAT(second("[9e-7, 30, 0.2, 0, 1]"),
              IsError(ErrorKind::kRange, {.key = "lookupTable/2", .value = "zenith"}));
  EXPECT_THAT(second("[9e-7, 0.1, 0.2, 180, 1]"),
              IsError(ErrorKind::kRange, {.key = "lookupTable/2", .value = "azimuth"}));
  EXPECT_THAT(second("[5e-7, 0.3, 0.2, 0, 1]"),
              IsError(ErrorKind::kMismatch, {.key = "lookupTable", .value = "500"}));
  EXPECT_THAT(second("[9.5e-7, 0.1, 0.2, 0, 1]"),
              IsError(ErrorKind::kMissing, {.key = "wavelengths", .value = "950"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
