#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

#include "tests/error_of.h"
#include "tests/io/formats/read_as.h"
#include "tests/paths.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;

std::string Header(const std::string& values, const std::string& points) {
  return "TITLE Garnet red\nDATE 1/2/1998\nNUM_POINTS " + points +
         "\nVARS theta_i,phi_i,theta_s,phi_s," + values + "\n";
}

Measurement Parse(const std::string& text) { return ReadAs("astm", text, "x.astm"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

TEST(AstmFile, ReadsColours) {
  const Measurement measurement = Parse(Header("B,G,R", "2") +
                                        "0.5,0.25,0.5,3.391593,3,2,1\r\n"
                                        "0.5,0,1.6,0,1,1,1\r\n");
  EXPECT_EQ(measurement.counts.total, 2);
  EXPECT_EQ(measurement.counts.below_surface, 1);
  ASSERT_EQ(measurement.samples.size(), 1);
  EXPECT_THAT(measurement.samples.rho[0], ElementsAre(1, 2, 3));
  EXPECT_NEAR(measurement.samples.angles[0].theta_h, 0, 1e-6);
  EXPECT_NEAR(measurement.samples.angles[0].theta_d, 0.5, 1e-6);
}

TEST(AstmFile, TakesOneValueForAllChannels) {
  for (const char* name : {"BRDF", "633nm"}) {
    const Measurement measurement = Parse(Header(name, "1") + "0,0,1,0,0.25\n");
    ASSERT_EQ(measurement.samples.size(), 1);
    EXPECT_THAT(measurement.samples.rho[0], ElementsAre(0.25, 0.25, 0.25));
  }
}

TEST(AstmFile, AzimuthsMatterWhereLightComesFromSeveral) {
  const std::string header = Header("R,G,B", "2"), first = "0.5,0,0.5,3,3,2,1\n";
  EXPECT_FALSE(Parse(header + first + "0.4,0,0.5,2,1,1,1\n").anisotropic);
  EXPECT_TRUE(Parse(header + first + "0.5,0.25,0.5,3.25,1,1,1\n").anisotropic);
}

TEST(AstmFile, ReadsSpectra) {
  const Measurement measurement =
      Parse(Header("400nm,450nm,500nm,550nm,600nm,650nm,700nm", "1") + "0,0,1,0,2,2,2,2,2,2,2\n");
  ASSERT_EQ(measurement.samples.size(), 1);
  for (const double x : measurement.samples.rho[0]) EXPECT_NEAR(x, 2, 1e-12);
}

// The same measurement in the other format of its authors.
TEST(AstmFile, ReadsWhatCornellMeasured) {
  const std::string path = MeasuredData("cornell/mystique.brdf");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  std::ifstream file(path);
  std::string line, names, rows;
  int points = 0;
  for (int wavelength = 400; wavelength <= 700; wavelength += 10) {
    names += (names.empty() ? "" : ",") + std::to_string(wavelength) + "nm";
  }
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string row, word;
    int count = 0;
    for (; words >> word; ++count) row += (count > 0 ? "," : "") + word;
    if (count != 35 || row[0] == '#') continue;
    rows += row + "\n";
    ++points;
  }
  ASSERT_EQ(points, 1439);
  const Measurement astm = Parse(Header(names, "1439") + rows);
  const Measurement cornell = LoadMeasurement(path);
  EXPECT_EQ(astm.samples.rho, cornell.samples.rho);
  EXPECT_EQ(astm.out_of_gamut, cornell.out_of_gamut);
}

TEST(AstmFile, ErrorsSayWhereAndWhatIsExpected) {
  EXPECT_THAT(ParseError("TITLE x\n0,0,0,0,1\n"),
              IsError(ErrorKind::kMissing, {.file = "x.astm", .key = "VARS"}));
  EXPECT_THAT(ParseError("VARS theta_i,phi_i,theta_s,R,G,B\n"),
              IsError(ErrorKind::kMissing, {.file = "x.astm", .line = 1, .key = "phi_s"}));
  EXPECT_THAT(ParseError(Header("X,Y,Z", "1")),
              IsError(ErrorKind::kMissing, {.line = 4, .key = "R"}));
  EXPECT_THAT(ParseError(Header("R,G", "1")),
              IsError(ErrorKind::kUnknown, {.line = 4, .key = "VARS", .value = "2"}));
  EXPECT_THAT(ParseError("VARS theta_i,phi_i,theta_s,phi_s\n"),
              IsError(ErrorKind::kUnknown, {.line = 1, .key = "VARS", .value = "0"}));
  EXPECT_THAT(ParseError(Header("400nm,450nm,x", "1")),
              IsError(ErrorKind::kUnknown, {.line = 4, .key = "VARS", .value = "3"}));
  EXPECT_THAT(ParseError(Header("R,G,B", "many")),
              IsError(ErrorKind::kFormat, {.line = 3, .key = "NUM_POINTS"}));
  EXPECT_THAT(ParseError(Header("R,G,B", "2") + "0,0,0,0,1,1,1\n"),
              IsError(ErrorKind::kMismatch, {.file = "x.astm", .key = "NUM_POINTS", .value = "2"}));
  EXPECT_THAT(
      ParseError(Header("R,G,B", "1") + "0,0,0,0,1,1\n"),
      IsError(ErrorKind::kFormat, {.file = "x.astm", .line = 5, .key = "columns", .value = "6"}));
  EXPECT_THAT(
      ParseError(Header("R,G,B", "1") + "0,0,0,0,1,one,1\n"),
      IsError(ErrorKind::kFormat, {.file = "x.astm", .line = 5, .key = "G", .value = "one"}));
  EXPECT_THAT(ParseError(Header("R,G,B", "1") + "45,0,0,0,1,1,1\n"),
              IsError(ErrorKind::kRange, {.line = 5, .key = "theta_i", .value = "45"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
