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

// The light comes from the azimuth inphi.
std::string File(double theta_i, double phi_i, const std::string& what, bool anisotropic = false) {
  std::string text = "#sample_name \"plastic\"\n#intheta " + Text(theta_i) + "\n#inphi " +
                     Text(phi_i) + "\n#upphi 90\n#format: theta phi " + what +
                     "\n# theta phi value\n";
  for (const double theta : {0.0, 25.0, 60.0, 120.0}) {
    for (const double phi : {0.0, 50.0, 180.0}) {
      const double rho = TrueValue(theta_i, phi_i, theta, phi, anisotropic)[1];
      const double cosine = what == "DSF" ? std::cos(DegreesToRadians(theta)) : 1;
      text += Text(theta) + " " + Text(phi) + "\t" + Text(rho * cosine) + "\n";
    }
  }
  return text;
}

Measurement Parse(const std::string& text) { return ReadAs("pab", text, "x.dat"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

TEST(PabFile, ReadsBackAKnownMaterial) {
  for (const std::string what : {"BRDF", "BSDF", "DSF"}) {
    const Measurement measurement = Source("any", File(30, 0, what)).Read();
    EXPECT_EQ(measurement.kind, "pab gonio-photometer file of scattered samples");
    EXPECT_EQ(measurement.counts.total, 12);
    EXPECT_EQ(measurement.counts.valid, 9);
    EXPECT_FALSE(measurement.anisotropic);
    ExpectTruth(measurement, /*grey=*/true);
  }
}

TEST(PabFile, FilesMayStandOneAfterTheOther) {
  const Measurement measurement = Parse(File(30, 0, "BRDF", true) + File(60, 90, "DSF", true));
  EXPECT_EQ(measurement.counts.valid, 18);
  EXPECT_TRUE(measurement.anisotropic);
  ExpectTruth(measurement, /*grey=*/true, /*anisotropic=*/true);
}

TEST(PabFile, TristimulusAndTheBackOfASample) {
  const Measurement measurement = Parse(
      "#incident_angle 150 20\n#colorimetry: CIE-XYZ\n#format: theta phi BSDF\n"
      "140 200 .5 .5 .5\n40 200 .1 .1 .1\n");
  ASSERT_EQ(measurement.samples.size(), 1);
  EXPECT_NEAR(RadiansToDegrees(measurement.samples.directions[0].theta_i), 30, 1e-9);
  EXPECT_NEAR(RadiansToDegrees(measurement.samples.directions[0].theta_o), 40, 1e-9);
  for (const double value : measurement.samples.rho[0]) EXPECT_NEAR(value, 0.5, 1e-6);
  EXPECT_THAT(measurement.notes[0], HasSubstr("X, Y, Z relative to white"));
}

TEST(PabFile, ErrorsSayWhereAndWhatIsExpected) {
  const std::string format = "#format: theta phi BRDF\n";
  EXPECT_THAT(ParseError("1 2 3\n"), IsError(ErrorKind::kMissing, {.line = 1, .key = "format"}));
  EXPECT_THAT(ParseError(format + "1 2 3\n"),
              IsError(ErrorKind::kMissing, {.line = 2, .key = "intheta, inphi"}));
  EXPECT_THAT(ParseError("#format: theta phi BTDF\n"),
              IsError(ErrorKind::kUnsupported, {.line = 1, .key = "format", .value = "BTDF"}));
  EXPECT_THAT(ParseError("#format: theta phi X\n"),
              IsError(ErrorKind::kUnknown, {.line = 1, .key = "format", .value = "X"}));
  EXPECT_THAT(ParseError("#colorimetry: RGB\n"),
              IsError(ErrorKind::kUnknown, {.line = 1, .key = "colorimetry", .value = "RGB"}));
  const std::string head = "#intheta 10\n#inphi 0\n" + format;
  EXPECT_THAT(ParseError(head + "1 2\n"),
              IsError(ErrorKind::kFormat, {.line = 4, .key = "columns", .value = "2"}));
  EXPECT_THAT(ParseError(head + "1 2 x\n"),
              IsError(ErrorKind::kFormat, {.line = 4, .key = "value", .value = "x"}));
  EXPECT_THAT(ParseError(head + "200 2 1\n"),
              IsError(ErrorKind::kRange, {.line = 4, .key = "theta", .value = "200"}));
  EXPECT_THAT(ParseError("#intheta x\n"),
              IsError(ErrorKind::kFormat, {.line = 1, .key = "an angle", .value = "x"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
