#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"
#include "tests/paths.h"
#include "tests/test_directory.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kBegin =
    "# a comment\nSource\tMeasured\nSymmetry\tAsymmetrical4D\nSpectralContent\tMonochrome\n"
    "ScatterType\tBRDF\n";
const std::string kAngles =
    "SampleRotation\t2\n0\t90\nAngleOfIncidence\t1\n30\nScatterAzimuth\t3\n0\t90\t180\n"
    "ScatterRadial\t3\n0\t20\t100\n";
const std::string kData =
    "\nMonochrome\nDataBegin\nTIS\t0.5\n1\t2\t0\n1\t3\t0\t\n1\t4\t0\n"
    "TIS\t0.5\n5\t6\t0\n5\t0\t0\n5\t8\t0\nDataEnd\n";

Measurement Parse(const std::string& text) { return ReadAs("zemax", text, "x.bsdf"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

Direction At(double theta_deg, double phi_deg) {
  const double theta = DegreesToRadians(theta_deg), phi = DegreesToRadians(phi_deg);
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

void ExpectNear(const Direction& a, const Direction& b) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-12);
}

TEST(ZemaxFile, AnglesAreAboutTheMirrorDirection) {
  const Measurement measurement = Parse(kBegin + kAngles + kData);
  EXPECT_EQ(measurement.kind, "Zemax BSDF file of scattered samples");
  EXPECT_TRUE(measurement.anisotropic);
  // A rotation has 1 + 3 samples around the mirror direction and 3 far from it, of which azimuth 0
  // is above the surface; in all, 3 gaps.
  EXPECT_EQ(measurement.counts.total, 14);
  EXPECT_EQ(measurement.counts.valid, 7);
  EXPECT_EQ(measurement.counts.missing, 3);
  EXPECT_EQ(measurement.counts.below_surface, 4);
  std::vector<double> values;
  for (const Rgb& rho : measurement.samples.rho) {
    EXPECT_THAT(rho, ElementsAre(rho[0], rho[0], rho[0]));
    values.push_back(rho[0]);
  }
  EXPECT_THAT(values, ElementsAre(1, 2, 3, 4, 5, 6, 8));
  const auto pair = [&](int j) { return ToDirections(measurement.samples.directions[j]); };
  // Unturned, the mirror direction lies over +x; azimuth 0 leads to the normal, 180 away from it,
  // and 90 to where the direction of azimuth 0 comes by a quarter turn about the mirror direction.
  ExpectNear(pair(0).wi, At(30, 180));
  ExpectNear(pair(0).wo, At(30, 0));
  ExpectNear(pair(1).wo, At(10, 0));
  ExpectNear(pair(3).wo, At(50, 0));
  const Direction mirror = At(30, 0), side = {0, -1, 0};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(pair(2).wo[k], std::cos(kPi / 9) * mirror[k] + std::sin(kPi / 9) * side[k], 1e-12);
  }
  // With the sample turned by 90 degrees the light moves by -90 degrees in its frame.
  ExpectNear(pair(4).wi, At(30, 90));
  ExpectNear(pair(4).wo, At(30, 270));
  ExpectNear(pair(5).wo, At(10, 270));
}

TEST(ZemaxFile, LeavesOutWhatIsThereTwice) {
  const Measurement measurement =
      Parse(kBegin +
            "SampleRotation\t2\n0\t360\nAngleOfIncidence\t1\n0\nScatterAzimuth\t3\n0\t180\t360\n"
            "ScatterRadial\t2\n0\t20\nMonochrome\nDataBegin\n"
            "TIS 1\n1 2\n1 3\n1 2\nTIS 1\n1 2\n1 3\n1 2\nDataEnd\n");
  EXPECT_EQ(measurement.counts.total, 3);
  EXPECT_EQ(measurement.counts.valid, 3);
  EXPECT_FALSE(measurement.anisotropic);
  ExpectNear(ToDirections(measurement.samples.directions[1]).wo, At(20, 180));
}

TEST(ZemaxFile, IsToldByItsContentOrEnding) {
  const TestDirectory directory;
  const std::string text = kBegin + kAngles + kData;
  EXPECT_EQ(LoadMeasurement(directory.Make("any", text)).counts.valid, 7);
  EXPECT_THAT(
      ErrorOf([&] { LoadMeasurement(directory.Make("x.bsdf", "Sauce Measured\n")); }),
      IsError(ErrorKind::kUnknown,
              {.file = directory.Path("x.bsdf"), .line = 1, .key = "header", .value = "Sauce"}));
}

TEST(ZemaxFile, ErrorsSayWhereAndWhatIsExpected) {
  EXPECT_THAT(ParseError(""), IsError(ErrorKind::kMissing, {.file = "x.bsdf", .key = "DataBegin"}));
  EXPECT_THAT(ParseError(kBegin + kData),
              IsError(ErrorKind::kMissing, {.line = 8, .key = "SampleRotation"}));
  EXPECT_THAT(ParseError(kAngles + kData),
              IsError(ErrorKind::kMissing, {.line = 11, .key = "ScatterType"}));
  const auto changed = [](const std::string& from, const std::string& after) {
    std::string text = kBegin + kAngles + kData;
    text.replace(text.find(from), from.size(), after);
    return ParseError(text);
  };
  EXPECT_THAT(changed("BRDF", "BTDF"),
              IsError(ErrorKind::kUnsupported,
                      {.file = "x.bsdf", .line = 5, .key = "ScatterType", .value = "BTDF"}));
  EXPECT_THAT(changed("Content\tMonochrome", "Content\tLab"),
              IsError(ErrorKind::kFormat, {.file = "x.bsdf", .line = 4}));
  EXPECT_THAT(changed("Content\tMonochrome", "Content\tXYZ"),
              IsError(ErrorKind::kMissing, {.line = 16, .key = "TristimulusX"}));
  EXPECT_THAT(changed("Rotation\t2", "Rotation\t2.5"),
              IsError(ErrorKind::kFormat, {.line = 6, .key = "SampleRotation"}));
  EXPECT_THAT(changed("Rotation\t2", "Rotation\t1000000000"),
              IsError(ErrorKind::kFormat, {.line = 6, .key = "SampleRotation"}));
  EXPECT_THAT(changed("Rotation\t2", "Rotation\t3"),
              IsError(ErrorKind::kFormat, {.line = 7, .key = "columns", .value = "2"}));
  EXPECT_THAT(changed("0\t90\t180", "0\t90\t90"),
              IsError(ErrorKind::kRange, {.line = 11, .key = "ScatterAzimuth", .value = "90"}));
  EXPECT_THAT(changed("0\t20\t100", "0\t20\t200"),
              IsError(ErrorKind::kRange, {.line = 13, .key = "ScatterRadial", .value = "200"}));
  EXPECT_THAT(changed("0\t20\t100", "0\t20\tnan"),
              IsError(ErrorKind::kRange, {.line = 13, .key = "ScatterRadial", .value = "nan"}));
  EXPECT_THAT(changed("TIS", "TES"), IsError(ErrorKind::kFormat, {.line = 17, .key = "TIS"}));
  EXPECT_THAT(changed("1\t2\t0", "1\t2"),
              IsError(ErrorKind::kFormat, {.line = 18, .key = "columns", .value = "2"}));
  EXPECT_THAT(
      changed("1\t2\t0", "1\tx\t0"),
      IsError(ErrorKind::kFormat, {.line = 18, .key = "BRDF by ScatterRadial", .value = "x"}));
  EXPECT_THAT(changed("DataEnd\n", ""),
              IsError(ErrorKind::kMissing, {.line = 24, .key = "DataEnd"}));
  EXPECT_THAT(changed("DataEnd", "1 2 3"),
              IsError(ErrorKind::kMismatch, {.line = 25, .key = "DataEnd"}));
  EXPECT_THAT(changed("TIS\t0.5\n5\t6\t0\n5\t0\t0\n5\t8\t0\n", ""),
              IsError(ErrorKind::kFormat, {.line = 21, .key = "TIS"}));
  // Values are samples like any other's.
  EXPECT_EQ(Parse([] {
              std::string text = kBegin + kAngles + kData;
              return text.replace(text.find("1\t2\t0"), 5, "-1\tnan\t0");
            }())
                .counts.negative,
            1);
}

// File of a known material: values at the directions of the format, in blocks.
const std::vector<double> kIncidences = {10, 50}, kAzimuths = {0, 45, 90, 135, 180},
                          kRadials = {0, 5, 30};

// The value of an azimuth and a distance about the mirror direction.
Rgb TruthAbout(double incidence, double azimuth, double radial) {
  const Direction mirror = At(incidence, 0), up = At(90 - incidence, 180);
  const Direction side = {0, -1, 0};  // mirror x up
  const double a = DegreesToRadians(azimuth), r = DegreesToRadians(radial);
  Direction wo;
  for (int k = 0; k < 3; ++k) {
    wo[k] = std::cos(r) * mirror[k] + std::sin(r) * (std::cos(a) * up[k] + std::sin(a) * side[k]);
  }
  if (!(wo[2] > 0)) return {};
  return TrueMaterial().brdf({At(incidence, 180), wo});
}

template <typename Value>
std::string Block(const std::string& name, const Value& value) {
  std::string text = name + "\nDataBegin\n";
  for (const double incidence : kIncidences) {
    text += "TIS 0.1\n";
    for (const double azimuth : kAzimuths) {
      for (const double radial : kRadials) {
        text += Text(value(TruthAbout(incidence, azimuth, radial))) + " ";
      }
      text += "\n";
    }
  }
  return text + "DataEnd\n";
}

std::string GeneratedHeader(const std::string& content) {
  return "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent " + content +
         "\nScatterType BRDF\nSampleRotation 1\n0\nAngleOfIncidence 2\n10 50\n"
         "ScatterAzimuth 5\n0 45 90 135 180\nScatterRadial 3\n0 5 30\n\n";
}

TEST(ZemaxFile, ReadsBackAKnownMaterial) {
  const Measurement grey = Parse(GeneratedHeader("Monochrome") +
                                 Block("Monochrome", [](const Rgb& rho) { return rho[1]; }));
  EXPECT_EQ(grey.counts.total, 2 * (1 + 5 * 2));
  ExpectTruth(grey, /*grey=*/true);
  std::string text = GeneratedHeader("RGB");
  for (int c = 0; c < kChannels; ++c) {
    text += Block(std::string("Tristimulus") + "RGB"[c], [c](const Rgb& rho) { return rho[c]; });
  }
  ExpectTruth(Parse(text), /*grey=*/false);
}

TEST(ZemaxFile, TristimulusValuesAreRelativeToWhite) {
  // sRGB's primaries (IEC 61966-2-1) and white.
  constexpr double kXyz[3][3] = {{0.4124564, 0.3575761, 0.1804375},
                                 {0.2126729, 0.7151522, 0.0721750},
                                 {0.0193339, 0.1191920, 0.9503041}};
  constexpr double kWhite[] = {0.95047, 1, 1.08883};
  std::string text = GeneratedHeader("XYZ");
  for (int k = 0; k < 3; ++k) {
    text += Block(std::string("Tristimulus") + "XYZ"[k], [&](const Rgb& rho) {
      return (kXyz[k][0] * rho[0] + kXyz[k][1] * rho[1] + kXyz[k][2] * rho[2]) / kWhite[k];
    });
  }
  const Measurement measurement = Parse(text);
  ExpectTruth(measurement, /*grey=*/false, /*anisotropic=*/false, 1e-5);
  EXPECT_THAT(measurement.notes, ElementsAre(HasSubstr("X, Y, Z relative to white")));
  EXPECT_THAT(ParseError(text.substr(0, text.find("TristimulusZ"))),
              IsError(ErrorKind::kMissing, {.line = 43, .key = "TristimulusZ"}));
  EXPECT_THAT(ParseError(text.replace(text.find("TristimulusY"), 12, "TristimulusZ")),
              IsError(ErrorKind::kFormat, {.line = 29, .key = "TristimulusY"}));
}

TEST(ZemaxFile, ReadsARealMeasurement) {
  const std::string path = MeasuredData("aniso/IMX455.bsdf");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const Measurement measurement = LoadMeasurement(path);
  EXPECT_TRUE(measurement.anisotropic);
  EXPECT_EQ(measurement.counts.total, 36 * 4 * (1 + 36 * 20));
  EXPECT_EQ(measurement.counts.valid, 47556);
  EXPECT_EQ(measurement.counts.missing, 6768);
  EXPECT_EQ(measurement.counts.below_surface, 49500);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
