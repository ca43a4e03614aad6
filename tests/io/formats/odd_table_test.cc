// Oddities of tables that instruments, spreadsheets and programs export.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "core/files/utf16.h"
#include "io/formats/text/given_angles.h"
#include "io/formats/text/table_lines.h"
#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kHead = "theta_i,phi_i,theta_o,phi_o,f\n";
const std::string kRows = "30,0,10,0,0.25\n30,0,20,180,0.5\n";

Measurement Read(const std::string& text, const SourceOptions& options = {}) {
  return Source("x.txt", text).Read(options);
}

std::optional<Error> ReadError(const std::string& text, const SourceOptions& options = {}) {
  return ErrorOf([&] { Read(text, options); });
}

// The advice for a table whose columns hold something else. It is made of the names of the columns,
// so that the words count.
std::string ReadAdvice(const std::string& text) {
  const std::optional<Error> error = ReadError(text);
  EXPECT_THAT(error, IsError(ErrorKind::kUnsupported, {.line = 1, .key = "columns"})) << text;
  return error ? error->what() : "";
}

// Checks that `text` reads as kHead + kRows, and the note on it.
void ExpectBoth(const std::string& text, const std::string& note,
                const SourceOptions& options = {}) {
  const Measurement is = Read(text, options), expected = Read(kHead + kRows);
  ASSERT_EQ(is.samples.rho, expected.samples.rho) << text;
  for (int j = 0; j < is.samples.size(); ++j) {
    const SphericalAngles &a = is.samples.directions[j], &b = expected.samples.directions[j];
    EXPECT_NEAR(a.theta_i, b.theta_i, 1e-12);
    EXPECT_NEAR(a.theta_o, b.theta_o, 1e-12);
    EXPECT_NEAR(a.phi_o - a.phi_i, b.phi_o - b.phi_i, 1e-12);
  }
  EXPECT_THAT(is.notes, ElementsAre(HasSubstr(note))) << text;
}

TEST(OddTable, TextBehindTheRowsIsLeftOut) {
  ExpectBoth(kHead + kRows + "End of data\nOperator: J. Smith\n", "2 lines after the table");
  EXPECT_THAT(
      ReadError(kHead + "30,0,10,0,0.25\nEnd of data\n30,0,20,180,0.5\n"),
      IsError(ErrorKind::kFormat, {.file = "x.txt", .line = 3, .key = "columns", .value = "1"}));
  // A row that breaks off is no text.
  EXPECT_THAT(ReadError(kHead + kRows + "30,0,2"),
              IsError(ErrorKind::kFormat, {.line = 4, .key = "columns", .value = "3"}));
}

TEST(OddTable, LinesGiveThetaIToTheRowsBelow) {
  const std::string rows = "10\t0\t0.25\n20\t180\t0.5\n", head = "theta_o\tphi_o\tBRDF\n";
  for (const std::string given : {"Incidence angle: 30 deg\n", "# theta_i = 30\n", "AOI\t30\n",
                                  "theta_i [rad]: 0.52359877559829882\n"}) {
    SCOPED_TRACE(given);
    ExpectBoth(given + head + rows, "theta_i = 30 deg");
  }
  const Measurement two =
      Read("Theta_i=20\n" + head + "1\t0\t2\nTheta_i=40\n" + head + "1\t0\t3\n");
  ASSERT_EQ(two.samples.size(), 2);
  EXPECT_NEAR(RadiansToDegrees(two.samples.directions[0].theta_i), 20, 1e-12);
  EXPECT_NEAR(RadiansToDegrees(two.samples.directions[1].theta_i), 40, 1e-12);
  EXPECT_THAT(two.notes, ElementsAre(HasSubstr("theta_i by lines between the rows")));
  EXPECT_FALSE(AnglesInLine("incidence angle: 30 samples"));
  EXPECT_FALSE(AnglesInLine("sample 30"));
  EXPECT_FALSE(AnglesInLine("theta_i: -30"));
  EXPECT_FALSE(AnglesInLine("theta_i [mrad]: 30"));
}

TEST(OddTable, ValuesThatAreNoBrdfAreNamed) {
  const auto error = [](const std::string& name) {
    return ReadAdvice("theta_i,theta_o,phi_o," + name + "\n30,10,0,0.25\n");
  };
  EXPECT_EQ(error("BTDF"),
            "x.txt: line 1: column 'BTDF' holds transmitted light, which is not read; the BRDF is "
            "what is reflected");
  EXPECT_THAT(error("log BRDF"), HasSubstr("--columns=theta_i,theta_o,phi_o,log10, or ln"));
  EXPECT_THAT(error("DHR"), HasSubstr("holds the reflectance of a hemisphere"));
  EXPECT_THAT(error("BRDF_s"), HasSubstr("holds light of one polarisation"));
}

TEST(OddTable, DecibelsAndLogarithmsAreRead) {
  const auto rows = [](const std::string& name, double first, double second) {
    std::ostringstream text;
    text.precision(17);
    text << "theta_i,phi_i,theta_o,phi_o," << name << "\n30,0,10,0," << first << "\n30,0,20,180,"
         << second << "\n";
    return text.str();
  };
  const double ln[] = {std::log(0.25), std::log(0.5)}, ln10 = std::log(10.0);
  const auto expect = [&](const std::string& name, double factor, const std::string& note) {
    const Measurement is = Read(rows(name, factor * ln[0], factor * ln[1]));
    ASSERT_EQ(is.samples.size(), 2) << name;
    EXPECT_NEAR(is.samples.rho[0][1], 0.25, 1e-15) << name;
    EXPECT_NEAR(is.samples.rho[1][2], 0.5, 1e-15) << name;
    EXPECT_THAT(is.notes, ElementsAre(HasSubstr(note))) << name;
  };
  for (const char* name : {"BRDF [dB]", "BRDF_dB", "dB"}) {
    expect(name, 10 / ln10, "decibels as 10^(dB/10)");
  }
  for (const char* name : {"log10(BRDF)", "lg f", "log10"}) {
    expect(name, 1 / ln10, "logarithms as 10^x");
  }
  expect("ln(BRDF)", 1, "logarithms as e^x");
}

// Theta_o counted from the mirror direction, in the plane of incidence.
TEST(OddTable, AnglesFromTheMirrorDirection) {
  const std::string rows = "30,-40,0.25\n30,-10,0.5\n";  // theta_o = -10 and 20
  for (const char* name :
       {"angle from specular [deg]", "theta_s - theta_spec", "off-specular", "delta_specular"}) {
    ExpectBoth(std::string("AOI,") + name + ",BRDF\n" + rows, "theta_o as theta_i and that angle");
  }
  ExpectBoth("Angle from specular\tBRDF\n-40\t0.25\n-10\t0.5\n", "theta_i = 30 deg",
             {.theta_i_deg = 30});
}

TEST(OddTable, RulesOfTablesInMarkdown) {
  ExpectBoth(
      "# Sheen\n\n| theta_i | phi_i | theta_o | phi_o | f |\n|---|:--:|---:|---|---|\n"
      "| 30 | 0 | 10 | 0 | 0.25 |\n| 30 | 0 | 20 | 180 | 0.5 |\n",
      "bars");
}

TEST(OddTable, WhatIsNoNumberIsToldHowToWrite) {
  const auto error = [](const std::string& cell) {
    return ReadError("theta_i;theta_o;phi_o;f\n30;10;0;" + cell + "\n");
  };
  for (const char* cell : {"1.234,5", "1,234.5", "1'234.5"}) {
    EXPECT_THAT(error(cell), IsError(ErrorKind::kFormat, {.line = 2, .key = "f", .value = cell}));
  }
  for (const char* cell : {"<0.1", "OVER", "0.1 ± 0.01"}) {
    EXPECT_THAT(error(cell), IsError(ErrorKind::kFormat, {.line = 2, .key = "f", .value = cell}));
  }
}

TEST(OddTable, ColumnsThatAreNoAnglesAreNamed) {
  const auto error = [](const std::string& header) { return ReadAdvice(header + "\n1,2,3,4\n"); };
  EXPECT_THAT(error("theta_i,beta_x,beta_y,f"), HasSubstr("'beta_x' is a sine of an angle (beta)"));
  EXPECT_THAT(error("theta_i,|B-B0|,x,f"), HasSubstr("|beta - beta0|"));
  EXPECT_THAT(error("cos_theta_i,phi_i,cos_theta_o,f"), HasSubstr("'cos_theta_i' is a cosine"));
  EXPECT_THAT(error("sample,Gloss 20,Gloss 60,Gloss 85"), HasSubstr("'Gloss 20' is of gloss"));
  EXPECT_THAT(ReadAdvice("Wavelength\tx.asd\n350\t0.1\n351\t0.1\n352\t0.2\n"),
              HasSubstr("this is a spectrum without angles"));
  EXPECT_THAT(ReadAdvice("theta_h,D\n0,3.5\n2,3.4\n4,3.3\n6,3.1\n"),
              HasSubstr("a distribution of normals"));
  EXPECT_THAT(ReadAdvice("350\t0.1\n351\t0.1\n352\t0.2\n"),
              HasSubstr("wavelengths and values of one pair of directions"));
  const std::string block = " 0\n10 10 12 11\n400,000 500,000 600,000 700,000\n\n";
  EXPECT_THAT(ReadAdvice("-80" + block + "-40" + block + "0" + block),
              HasSubstr("blocks, each of a line of two angles and two of 4 numbers"));
  std::string line = "1";
  for (int k = 0; k < 205; ++k) line += " 0.05";
  EXPECT_THAT(ReadError(line + "\n" + line + "\n"), IsError(ErrorKind::kFormat, {.line = 1}));
  EXPECT_THAT(error("sza,vza,band1,band2"),
              HasSubstr("if they are of MODIS, and reflectance factors, pi f, type "
                        "--columns=theta_i,theta_o,645nm,859nm --scale=0.3183"));
  EXPECT_THAT(error("sza,vza,B02,B03,B04"),
              HasSubstr("--columns=theta_i,theta_o,490nm,560nm,665nm --bands=665,560,490"));
  EXPECT_THAT(error("sza,vza,ch1,ch2"), HasSubstr("--columns=theta_i,theta_o,645nm,-"));
}

TEST(OddTable, AHeaderMayComeAgain) {
  ExpectBoth(
      "theta_i; phi_i; theta_o; phi_o; f;\n30; 0; 10; 0; 0.25;\n"
      "theta_i; phi_i; theta_o; phi_o; f;\n30; 0; 20; 180; 0.5;\n",
      "read as: semicolons");
}

TEST(OddTable, CellsOfSpreadsheets) {
  const Measurement gaps = Read(kHead + "30,0,10,0,#N/A\n30,0,20,180,0.5 # bright\n" +
                                "30,0,30,180,#DIV/0!\n30,0,40,180,#NV\n");
  EXPECT_EQ(gaps.samples.size(), 1);
  EXPECT_EQ(gaps.counts.missing, 3);
  ExpectBoth("theta_i,phi_i,theta_o,phi_o,f\n30°,0°,10°,0°,0.25\n30°,0 deg,20°,180°,0.5\n",
             "degrees");
  ExpectBoth("theta_i phi_i theta_o phi_o f\n30 0 10 0 2.5D-01\n30 0 20 180 0.5D+00\n", "blanks");
  // Cells that are not read may be missing at the end.
  ExpectBoth(
      "theta_i\tphi_i\ttheta_o\tphi_o\tf\tComment\n30\t0\t10\t0\t0.25\t\n"
      "30\t0\t20\t180\t0.5\tbright\n",
      "left out: 'Comment'");
  EXPECT_FALSE(OddNumber("30x"));
  EXPECT_FALSE(OddNumber("D3"));
}

TEST(OddTable, RowsOfRHaveNames) {
  ExpectBoth(
      "\"theta_i\" \"phi_i\" \"theta_o\" \"phi_o\" \"f\"\n\"1\" 30 0 10 0 0.25\n"
      "\"2\" 30 0 20 180 0.5\n",
      "blanks");
}

TEST(OddTable, OtherUnitsAndLanguages) {
  ExpectBoth(
      "theta_i [gon],phi_i [gon],theta_o [gon],phi_o [gon],f\n"
      "33.333333333333333,0,11.111111111111111,0,0.25\n"
      "33.333333333333333,0,22.222222222222222,200,0.5\n",
      "read as: gon");
  EXPECT_THAT(
      ReadError("theta_i [arcmin],phi_i,theta_o,phi_o,f\n1,0,1,0,1\n"),
      IsError(ErrorKind::kUnsupported, {.line = 1, .key = "theta_i [arcmin]", .value = "arcmin"}));
  ExpectBoth("Einfallswinkel [°];Ausfallswinkel [°];Azimut [°];BRDF\n30;10;0;0,25\n30;20;180;0,5\n",
             "decimal commas");
  // In Latin-1.
  ExpectBoth(
      "angle d'incidence (\xB0);angle d'observation (\xB0);azimut (\xB0);FRDB (sr-1)\n"
      "30;10;0;0,25\n30;20;180;0,5\n",
      "decimal commas");
}

TEST(OddTable, TextInUtf16) {
  std::string little = "\xFF\xFE", big = "\xFE\xFF";
  for (const char c : kHead + kRows) {
    little += {c, '\0'};
    big += {'\0', c};
  }
  for (const std::string& text : {little, big}) {
    EXPECT_EQ(Read(text).samples.rho, Read(kHead + kRows).samples.rho);
  }
  using namespace std::string_literals;
  EXPECT_EQ(Utf8OfUtf16("\xFF\xFE\xB8\x03\x3D\xD8\x00\xDE"s), "θ\U0001F600");
  EXPECT_EQ(Utf8OfUtf16("\xFF\xFE\x3D\xD8"s), "");  // half a pair
  EXPECT_EQ(Utf8OfUtf16("\xFF\xFE\x00\xDE"s), "");  // the other half
  EXPECT_EQ(Utf8OfUtf16("\xFF\xFE\x3D"s), "");      // half a unit
  EXPECT_EQ(Utf8OfUtf16("theta_i"s), "");
}

TEST(OddTable, AMatrixHasAnglesOnBothAxes) {
  const std::string rows = "10 0.25 7\n20 8 0.5\n";
  const std::vector<Rgb> rho = {{0.25, 0.25, 0.25}, {7, 7, 7}, {8, 8, 8}, {0.5, 0.5, 0.5}};
  const SourceOptions by_flags = {.columns = "theta_o/phi_o", .theta_i_deg = 30};
  for (const std::string header : {"0 0 180\n", "0 180\n", "% scan 3\n0 0 180\n"}) {
    const Measurement read = Read(header + rows, by_flags);
    EXPECT_EQ(read.samples.rho, rho) << header;
    EXPECT_NEAR(read.samples.directions[1].phi_o, kPi, 1e-12);
    EXPECT_NEAR(RadiansToDegrees(read.samples.directions[1].theta_o), 10, 1e-12);
    EXPECT_THAT(read.notes, ElementsAre(HasSubstr("read as: a matrix, ")));
  }
  EXPECT_EQ(Read("theta_i: 30\ntheta_o\\phi_o,0,180\n10,0.25,7\n20,8,0.5\n").samples.rho, rho);
  const Measurement blocks =
      Read("theta_i = 20\n0 0 180\n" + rows + "theta_i = 40\n0 0 180\n" + rows,
           {.columns = "theta_o/phi_o"});
  EXPECT_EQ(blocks.samples.size(), 8);
  EXPECT_NEAR(RadiansToDegrees(blocks.samples.directions[4].theta_i), 40, 1e-12);
  const Measurement wide =
      Read("theta_o,BRDF at 20 deg,BRDF at 40 deg\n10,1,2\n", {.columns = "theta_o/theta_i"});
  EXPECT_NEAR(RadiansToDegrees(wide.samples.directions[1].theta_i), 40, 1e-12);
  EXPECT_THAT(ReadError("0 0 180\n10 1\n", by_flags),
              IsError(ErrorKind::kFormat, {.file = "x.txt", .line = 2}));
  EXPECT_THAT(ReadError("nothing\n", by_flags), IsError(ErrorKind::kMissing, {.key = "columns"}));
  EXPECT_THAT(ReadError("% phi in columns\n" + rows), IsError(ErrorKind::kFormat, {.line = 2}));
}

TEST(OddTable, ColumnsThatHoldSomethingElseAreNamed) {
  const std::string angles = "aoi,theta_s,phi_s,", rows = "\n30,10,0,1\n";
  EXPECT_EQ(ReadAdvice(angles + "CCBRDF" + rows),
            "x.txt: line 1: column 'CCBRDF' holds f times cos theta_o; type "
            "--columns=theta_i,theta_o,phi_o,f --cosine=o:1");
  EXPECT_THAT(ReadAdvice(angles + "Reflectance factor (%)" + rows),
              HasSubstr("percents of pi f; type --columns=theta_i,theta_o,phi_o,f "
                        "--scale=0.003183"));
  EXPECT_THAT(ReadAdvice(angles + "counts" + rows), HasSubstr("what a detector reads"));
  EXPECT_THAT(ReadAdvice("aoi,theta_s,phi_s,X,Y,Z\n30,10,0,1,1,1\n"), HasSubstr("X, Y, Z"));
  EXPECT_THAT(ReadAdvice("wi_x,wi_y,wi_z,theta_o,f\n0,0,1,10,1\n"), HasSubstr("are vectors"));
  EXPECT_THAT(ReadAdvice("theta_h,theta_d,theta_o,f\n0,0,1,10\n"),
              HasSubstr("half and difference"));
  EXPECT_THAT(ReadAdvice("theta_o,BRDF at 20 deg,BRDF at 40 deg\n10,1,2\n"),
              HasSubstr("--columns=theta_o/theta_i"));
  // With the flags that they ask for, the table is read.
  const Measurement asked =
      Read(angles + "CCBRDF" + rows, {.cosine_o = 1, .columns = "theta_i,theta_o,phi_o,f"});
  EXPECT_NEAR(asked.samples.rho[0][0], 1 / std::cos(DegreesToRadians(10)), 1e-12);
}

// The angle g between the directions, as astronomers have it, gives the azimuth.
TEST(OddTable, AzimuthsByThePhase) {
  // 1e-12 in cos g is 1e-6 in the azimuth.
  const auto close = [](const Measurement& is, double degrees) {
    const SphericalAngles& at = is.samples.directions[0];
    EXPECT_NEAR(RadiansToDegrees(std::abs(std::remainder(at.phi_o - at.phi_i, 2 * kPi))), degrees,
                1e-3);
  };
  for (const char* const header :
       {"i,e,g,BRDF\n", "incidence,emission,phase,f\n", "i_deg,e_deg,g_deg,BRDF\n",
        "theta_i,theta_o,phase angle [deg],f\n"}) {
    SCOPED_TRACE(header);
    close(Read(std::string(header) + "20,10,10,1\n"), 0);
    close(Read(std::string(header) + "20,10,30,1\n"), 180);
    close(Read(std::string(header) + "20,10,22.26874,1\n"), 90);
    close(Read(std::string(header) + "20,10,30.4,1\n"), 180);  // rounded
    EXPECT_THAT(ReadError(std::string(header) + "20,10,40,1\n"),
                IsError(ErrorKind::kRange, {.line = 2, .value = "40"}));
  }
  EXPECT_THAT(Read("i,e,g,BRDF\n20,10,25,1\n").notes,
              ElementsAre(HasSubstr("'i' as theta_i, 'e' as theta_o")));
  EXPECT_THAT(Read("i,e,g,BRDF\n20,10,25,1\n").notes,
              ElementsAre(HasSubstr("azimuths by the angle between the directions")));
  // Beside an azimuth it is left out, and g beside r and b is green.
  EXPECT_THAT(Read("i,e,phi,phase,BRDF\n20,10,90,25,1\n").notes,
              ElementsAre(HasSubstr("left out: 'phase'")));
  EXPECT_EQ(Read("i,theta_i,theta_o,f,e\n1,20,10,5,0.1\n").samples.rho[0][0], 5);
  EXPECT_EQ(Read("i,e,phi,r,g,b\n20,10,90,1,2,3\n").samples.rho[0], (Rgb{1, 2, 3}));
}

TEST(OddTable, AScanWithoutThetaIAsksForIt) {
  const std::string scan = "angle\tvalue\n-10\t1\n10\t2\n";
  EXPECT_THAT(ReadError(scan), IsError(ErrorKind::kMissing, {.line = 1, .key = "theta_i"}));
  EXPECT_EQ(Read(scan, {.theta_i_deg = 30}).samples.size(), 2);
  EXPECT_THAT(ReadError(""), IsError(ErrorKind::kFormat, {.key = "content", .value = "empty"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
