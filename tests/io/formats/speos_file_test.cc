#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/albedo.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string Row(const std::vector<double>& numbers) {
  std::string row;
  for (const double number : numbers) row += Text(number) + "\t";
  return row + "\n";
}

std::vector<double> Steps(double first, double last, double step) {
  std::vector<double> steps;
  for (double at = first; at <= last; at += step) steps.push_back(at);
  return steps;
}

// f(theta, phi) in degrees.
std::string Table(const std::vector<double>& thetas, const std::vector<double>& phis,
                  const std::function<double(double, double)>& f) {
  std::string text =
      std::to_string(thetas.size()) + " " + std::to_string(phis.size()) + "\n\t" + Row(phis);
  for (const double theta : thetas) {
    std::vector<double> row = {theta};
    for (const double phi : phis) row.push_back(f(theta, phi));
    text += Row(row);
  }
  return text;
}

std::string Head(const std::string& what, const std::string& flags) {
  return "OPTIS - " + what + "\n0\na comment\n12\ntwo\nlines: 2\n" + flags;
}
const std::string kSpectral = "brdf surface file v9.0",
                  kAnisotropic = "Anisotropic BSDF surface file v8.0";

Measurement Parse(const std::string& text) { return ReadAs("speos", text, "x.brdf"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

// The mirror direction has phi = 0, and the light the azimuth 180 - rotation.
double Truth(double theta_i, double theta, double phi, int channel, double rotation = 0,
             bool anisotropic = false) {
  return TrueValue(theta_i, 180 - rotation, theta, phi - rotation, anisotropic)[channel];
}

double PercentOf(double theta_i, int channel) {
  return 100 * DirectionalAlbedo(TrueMaterial().brdf, DegreesToRadians(theta_i))[channel];
}

TEST(SpeosFile, TablesAreScaledToTheirReflectance) {
  // Ten times too large; and an intensity.
  for (const bool is_bsdf : {true, false}) {
    std::string text =
        Head(kSpectral, is_bsdf ? "1 0\n1\n2 1\n" : "1 0\n0\n2 1\n") + "20 45\n550\n";
    for (const double theta_i : {20.0, 45.0}) {
      const auto value = [&](double theta, double phi) {
        const double cosine = is_bsdf ? 1 : std::cos(DegreesToRadians(theta));
        return 10 * cosine * Truth(theta_i, theta, phi, 1);
      };
      text +=
          Text(PercentOf(theta_i, 1)) + "\n" + Table(Steps(0, 90, 0.5), Steps(0, 180, 2), value);
    }
    const Measurement measurement = Source("any", text).Read();
    EXPECT_EQ(measurement.kind, "Speos BRDF file of scattered samples");
    EXPECT_FALSE(measurement.anisotropic);
    EXPECT_EQ(measurement.counts.total, 2 * (180 * 91 + 1));
    EXPECT_THAT(measurement.notes[0], HasSubstr(is_bsdf ? "to a BRDF" : "to an intensity"));
    ExpectTruth(measurement, /*grey=*/true, /*anisotropic=*/false, /*tolerance=*/0.01);
  }
}

TEST(SpeosFile, WavelengthsMakeASpectrumAndTransmissionIsSkipped) {
  const std::string reflected =
      "50\n" + Table({0, 45, 90}, {0, 90, 180}, [](double, double) { return 1.0; });
  const std::string transmitted =
      "20\n" + Table({90, 180}, {0, 180}, [](double, double) { return 1.0; });
  std::string text = Head(kSpectral, "1 1\n1\n1 13\n") + "30\n" + Row(Steps(400, 700, 25));
  for (int k = 0; k < 13; ++k) text += reflected;
  const Measurement measurement = Parse(text + transmitted);
  EXPECT_EQ(measurement.counts.valid, 4);
  for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(measurement.samples.rho[0][c], 0.5 / kPi, 1e-3);
  EXPECT_EQ(
      Parse(text.substr(0, text.size() - reflected.size()) + transmitted + reflected).counts.valid,
      4);
}

TEST(SpeosFile, AnisotropyAnglesTurnTheSample) {
  std::string text = Head(kAnisotropic, "0 1 0\n1 0\n1\n3\n0 90 360\n") +
                     "2\n10 40\n2\n10 40\n2\n10 40\n40 0\n\n2\n350 10\n850 10\n";
  double light = 0;
  for (const double rotation : {0.0, 90.0, 360.0}) {
    for (const double theta_i : {10.0, 40.0}) {
      text += Table(Steps(0, 90, 5), Steps(0, 345, 15), [&](double theta, double phi) {
        return Truth(theta_i, theta, phi, 1, rotation, true);
      });
    }
  }
  const Measurement measurement = Parse(text + "End of file\n");
  EXPECT_TRUE(measurement.anisotropic);
  EXPECT_EQ(measurement.counts.total, 2 * 2 * (18 * 24 + 1));
  // All by one scale, which the table at 40 degrees has.
  for (int j = 0; j < measurement.samples.size(); ++j) {
    const double truth =
        TrueMaterial(true).brdf(ToDirections(measurement.samples.directions[j]))[1];
    if (j == 0) light = measurement.samples.rho[j][0] / truth;
    EXPECT_NEAR(measurement.samples.rho[j][0] / truth, light, 1e-9 * light);
  }
  EXPECT_GT(light, 0.05);
  EXPECT_LT(light, 1);
}

TEST(SpeosFile, AnAnisotropicFileTakesItsColorFromTheSpectrum) {
  const std::string text = Head(kAnisotropic, "1 0 0\n1 0\n1\n1\n0\n2\n10 40\n25 0\nby hand\n3\n") +
                           "380 0\n580 0\n780 60\n" +
                           Table({0, 90}, {0, 180}, [](double, double) { return 2.0; }) +
                           Table({0, 90}, {0, 180}, [](double, double) { return 4.0; });
  const Measurement measurement = Parse(text);
  ASSERT_EQ(measurement.samples.size(), 2);
  EXPECT_FALSE(measurement.anisotropic);
  const Rgb &first = measurement.samples.rho[0], &second = measurement.samples.rho[1];
  EXPECT_GT(first[0], 10 * first[2]);
  EXPECT_NEAR(second[0], 2 * first[0], 1e-12);
  // Halfway between the scales of both: 1 / (2 pi) and 1 / (4 pi).
  const Measurement grey = Parse(Head(kAnisotropic, "1 0 0\n1 0\n1\n1\n0\n2\n10 40\n25 0\n\n1\n") +
                                 "550 30\n" + text.substr(text.find("780 60\n") + 7));
  EXPECT_NEAR(grey.samples.rho[0][1], 0.3 * 2 * 0.75 / (2 * kPi), 1e-3);
}

TEST(SpeosFile, ErrorsSayWhereAndWhatIsExpected) {
  const std::string head = "OPTIS - brdf surface file v8.0\n";
  EXPECT_THAT(ParseError("x\n"), IsError(ErrorKind::kFormat, {.line = 1, .key = "header"}));
  EXPECT_THAT(ParseError("OPTIS - brdf surface file v5.1\n"),
              IsError(ErrorKind::kUnsupported, {.line = 1, .key = "version", .value = "v5.1"}));
  EXPECT_THAT(ParseError(head + "1\n"),
              IsError(ErrorKind::kUnsupported, {.line = 2, .key = "mode"}));
  EXPECT_THAT(ParseError(head), IsError(ErrorKind::kMissing, {.line = 2, .key = "the mode"}));
  EXPECT_THAT(ParseError(head + "0\nc\n-1\n"),
              IsError(ErrorKind::kRange, {.line = 4, .key = "length", .value = "-1"}));
  EXPECT_THAT(ParseError(head + "0\nc\n1\n-\n0 1\n"),
              IsError(ErrorKind::kUnsupported, {.line = 6, .key = "reflection"}));
  const std::string begin = head + "0\nc\n1\n-\n1 0\n1\n";
  EXPECT_THAT(
      ParseError(begin + "0 1\n"),
      IsError(ErrorKind::kRange, {.line = 8, .key = "the number of incidences", .value = "0"}));
  EXPECT_THAT(ParseError(begin + "2 1\n5 4\n"),
              IsError(ErrorKind::kRange, {.line = 9, .key = "incidences", .value = "4"}));
  EXPECT_THAT(ParseError(begin + "1 1\n5\n550\n10\n1 3\n0 40 100\n0 1 1 1\n"),
              IsError(ErrorKind::kRange, {.line = 14, .key = "phi", .value = "100"}));
  EXPECT_THAT(ParseError(begin + "1 1\n5\n550\n10\n2 1\n0\n5 1\n4 1\n"),
              IsError(ErrorKind::kRange, {.line = 15, .key = "theta", .value = "4"}));
  EXPECT_THAT(ParseError(begin + "1 1\n5\n550\nx\n"),
              IsError(ErrorKind::kFormat, {.line = 11, .key = "a reflectance [%]", .value = "x"}));
  EXPECT_THAT(ParseError(begin + "1 1\n5\n550\n2000\n1 1\n0\n5 1\n"),
              IsError(ErrorKind::kRange, {.line = 14, .key = "reflectance", .value = "20"}));
  const std::string other = begin + "1 13\n5\n" + Row(Steps(400, 700, 25)) + "1\n1 1\n0\n5 1\n";
  EXPECT_THAT(ParseError(other + "1\n1 1\n0\n6 1\n"),
              IsError(ErrorKind::kMismatch, {.line = 18, .key = "angles"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
