#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;

const std::vector<double> kAzimuths = {0, 60, 120, 180, 240, 300, 360}, kRadials = {0, 20, 60};

std::string Head(const std::string& content = "Monochrome") {
  return "# by hand\nSource Measured\nSymmetry Asymmetric\nSpectralContent " + content +
         "\nScatterAzimuth 7\n0 60 120 180 240 300 360\nScatterRadial 3\n0 20 60\nDataBegin\n";
}

// Light comes from the azimuth 90 + POI degrees.
template <typename Value>
std::string Block(double aoi, double poi, const std::string& keys, const Value& value,
                  bool anisotropic = false) {
  std::string text = "AOI " + Text(aoi) + " POI " + Text(poi) + " Side Front\n" + keys +
                     " ScatterType BRDF TIS 0.2\n";
  for (const double azimuth : kAzimuths) {
    for (const double radial : kRadials) {
      text += Text(value(TrueValue(aoi, 90 + poi, radial, azimuth, anisotropic))) + " ";
    }
    text += "\n";
  }
  return text;
}

double Green(const Rgb& rho) { return rho[1]; }

Measurement Parse(const std::string& text) { return ReadAs("lighttools", text, "x.bsdf"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

TEST(LightToolsFile, ReadsBackAKnownMaterial) {
  const std::string text = Head() + Block(20, 0, "Wavelength 550", Green) +
                           Block(60, 0, "Wavelength 550", Green) + "DataEnd\n";
  const Measurement measurement = Source("any", text).Read();
  EXPECT_EQ(measurement.kind, "LightTools BSDF file of scattered samples");
  EXPECT_EQ(measurement.counts.total, 2 * (1 + 6 * 2));
  EXPECT_FALSE(measurement.anisotropic);
  EXPECT_THAT(measurement.notes, testing::Contains("read as: front reflection, 550 nm"));
  ExpectTruth(measurement, /*grey=*/true);
}

TEST(LightToolsFile, PlanesOfIncidenceMakeItAnisotropic) {
  std::string text = Head();
  for (const double poi : {0.0, 45.0}) text += Block(30, poi, "Wavelength 550", Green, true);
  const Measurement measurement = Parse(text + "DataEnd\n");
  EXPECT_TRUE(measurement.anisotropic);
  ExpectTruth(measurement, /*grey=*/true, /*anisotropic=*/true);
}

TEST(LightToolsFile, WavelengthsMakeSpectra) {
  std::string text = Head();
  for (int wavelength = 700; wavelength >= 400; wavelength -= 50) {
    text += Block(30, 0, "Wavelength " + std::to_string(wavelength), Green);
  }
  const Measurement measurement = Parse(text + "DataEnd\n");
  EXPECT_EQ(measurement.counts.total, 1 + 6 * 2);
  EXPECT_THAT(
      measurement.notes,
      ElementsAre("read as: front reflection, 7 wavelengths to RGB by CIE 1931 (--bands picks "
                  "some)"));
  ExpectTruth(measurement, /*grey=*/true);  // a constant spectrum is grey
  EXPECT_THAT(ParseError(text + Block(40, 0, "Wavelength 700", Green) + "DataEnd\n"),
              IsError(ErrorKind::kMismatch, {.file = "x.bsdf", .key = "blocks", .value = "40"}));
  EXPECT_THAT(ParseError(text + Block(30, 0, "Wavelength 700", Green) + "DataEnd\n"),
              IsError(ErrorKind::kConflict, {.line = 81, .key = "block"}));
}

TEST(LightToolsFile, TristimulusValues) {
  std::string text = Head("XYZ");
  for (const char* const key : {"TrisY", "TrisX"}) {
    text += Block(30, 0, std::string("TristimulusValue ") + key, Green);
  }
  EXPECT_THAT(ParseError(text + "DataEnd\n"),
              IsError(ErrorKind::kMismatch, {.key = "blocks", .value = "30"}));
  const Measurement grey = Parse(text + Block(30, 0, "TristimulusValue TrisZ", Green) + "DataEnd");
  ExpectTruth(grey, /*grey=*/true, /*anisotropic=*/false, 1e-5);
}

TEST(LightToolsFile, OnlyFrontReflectionIsRead) {
  std::string other = Block(20, 0, "Wavelength 550", Green);
  other.replace(other.find("Front"), 5, "Back");
  std::string through = Block(20, 0, "Wavelength 550", Green);
  through.replace(through.find("BRDF"), 4, "BTDF");
  const Measurement measurement =
      Parse(Head() + other + Block(20, 0, "Wavelength 550", Green) + through + "DataEnd\n");
  EXPECT_EQ(measurement.counts.total, 1 + 6 * 2);
  EXPECT_THAT(
      measurement.notes,
      ElementsAre("read as: front reflection, 550 nm; 2 blocks of transmission or the back are "
                  "left out"));
  EXPECT_THAT(ParseError(Head() + other + through + "DataEnd\n"),
              IsError(ErrorKind::kUnsupported, {.file = "x.bsdf", .key = "blocks"}));
}

TEST(LightToolsFile, ErrorsSayWhereAndWhatIsExpected) {
  EXPECT_THAT(ParseError(""), IsError(ErrorKind::kMissing, {.file = "x.bsdf", .key = "DataBegin"}));
  const auto changed = [](const std::string& from, const std::string& after) {
    std::string text = Head() + Block(20, 0, "Wavelength 550", Green) + "DataEnd\n";
    text.replace(text.find(from), from.size(), after);
    return ParseError(text);
  };
  EXPECT_THAT(changed("Asymmetric", "Other"),
              IsError(ErrorKind::kUnsupported,
                      {.file = "x.bsdf", .line = 3, .key = "Symmetry", .value = "Other"}));
  EXPECT_THAT(
      changed("Monochrome", "RGB"),
      IsError(ErrorKind::kUnsupported, {.line = 4, .key = "SpectralContent", .value = "RGB"}));
  EXPECT_THAT(changed("ScatterRadial 3\n0 20 60\n", ""),
              IsError(ErrorKind::kMissing, {.line = 7, .key = "ScatterRadial"}));
  EXPECT_THAT(changed("ScatterRadial 3", "ScatterRadial 100000000"),
              IsError(ErrorKind::kFormat, {.line = 7, .key = "ScatterRadial"}));
  EXPECT_THAT(changed("Source Measured", "Source"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "DataBegin"}));
  EXPECT_THAT(changed("Source", "Sauce"),
              IsError(ErrorKind::kUnknown, {.line = 2, .key = "header", .value = "Sauce"}));
  EXPECT_THAT(changed("AOI 20", "AOI 200"),
              IsError(ErrorKind::kRange, {.line = 10, .key = "AOI", .value = "200"}));
  EXPECT_THAT(changed("AOI 20", "AOI"), IsError(ErrorKind::kFormat, {.line = 10, .key = "block"}));
  EXPECT_THAT(changed("AOI", "AOL"),
              IsError(ErrorKind::kUnknown, {.line = 10, .key = "block", .value = "AOL"}));
  EXPECT_THAT(changed("Front", "Left"),
              IsError(ErrorKind::kUnsupported, {.line = 10, .key = "Side", .value = "Left"}));
  EXPECT_THAT(
      changed("BRDF", "BSDF"),
      IsError(ErrorKind::kUnsupported, {.line = 11, .key = "ScatterType", .value = "BSDF"}));
  EXPECT_THAT(changed("Wavelength 550", "Wavelength inf"),
              IsError(ErrorKind::kRange, {.line = 18, .key = "Wavelength", .value = "inf"}));
  EXPECT_THAT(changed("DataEnd", "7 8"),
              IsError(ErrorKind::kUnknown, {.line = 19, .key = "block", .value = "7"}));
  EXPECT_THAT(changed("DataEnd\n", ""),
              IsError(ErrorKind::kMissing, {.line = 18, .key = "DataEnd"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
