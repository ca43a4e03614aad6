// Tables as people have them are read as the same samples between commas are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/formats/spectrum.h"
#include "io/formats/text/table_columns.h"
#include "tests/error_of.h"
#include "tests/paths.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kPlain =
    "theta_i,phi_i,theta_o,phi_o,r,g,b\n"
    "5,0,0,0,0.25,0.5,0.75\n"
    "10,0,60.5,123.5,0.1,2e-5,3\n"
    "45,0,45,180,1,0,0.125\n";

Measurement Read(const std::string& text, const SourceOptions& options = {},
                 const std::string& name = "x.csv") {
  return Source(name, text).Read(options);
}

std::optional<Error> ReadError(const std::string& text, const SourceOptions& options = {},
                               const std::string& name = "x.csv") {
  return ErrorOf([&] { Read(text, options, name); });
}

void ExpectSameSamples(const Measurement& is, const Measurement& expected) {
  ASSERT_EQ(is.samples.rho, expected.samples.rho);
  for (int j = 0; j < is.samples.size(); ++j) {
    const SphericalAngles &a = is.samples.directions[j], &b = expected.samples.directions[j];
    EXPECT_NEAR(a.theta_i, b.theta_i, 1e-12);
    EXPECT_NEAR(a.theta_o, b.theta_o, 1e-12);
    EXPECT_NEAR(std::remainder(a.phi_i - b.phi_i, 2 * kPi), 0, 1e-12);
    EXPECT_NEAR(std::remainder(a.phi_o - b.phi_o, 2 * kPi), 0, 1e-12);
  }
  EXPECT_EQ(is.counts.total, expected.counts.total);
  EXPECT_EQ(is.anisotropic, expected.anisotropic);
}

// Checks that `text` is kPlain in another form, and the note on it.
void ExpectPlain(const std::string& text, const std::string& note,
                 const SourceOptions& options = {}) {
  const Measurement read = Read(text, options, "x.txt");
  ExpectSameSamples(read, Read(kPlain));
  EXPECT_THAT(read.notes, ElementsAre("read as: " + note));
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

TEST(TextTable, PlainTablesHaveNoNote) { EXPECT_THAT(Read(kPlain).notes, ElementsAre()); }

TEST(TextTable, AnySeparatorAndDecimalCommas) {
  const std::string semicolons = Replaced(kPlain, ",", ";");
  ExpectPlain(semicolons, "semicolons, degrees, f in 1/sr");
  ExpectPlain(Replaced(semicolons, ".", ","), "semicolons, decimal commas, degrees, f in 1/sr");
  ExpectPlain(Replaced(Replaced(kPlain, ",", "\t"), ".", ","),
              "tabs, decimal commas, degrees, f in 1/sr");
  ExpectPlain(Replaced(kPlain, ",", "|"), "bars, degrees, f in 1/sr");
  ExpectPlain(Replaced(kPlain, ",", "   "), "blanks, degrees, f in 1/sr");
  ExpectPlain(Replaced(kPlain, ",", "\t\t"), "blanks, degrees, f in 1/sr");
  EXPECT_THAT(Read(Replaced(kPlain, "\n", ",\n")).notes, ElementsAre());
  EXPECT_THAT(Read(Replaced(kPlain, "\n", "\r")).notes, ElementsAre());
  EXPECT_THAT(Read(Replaced(kPlain, "\n", "\r\n")).notes, ElementsAre());
  EXPECT_EQ(Read(Replaced(kPlain, "\n", "\r")).counts.valid, 3);
}

TEST(TextTable, QuotesAndHeadersInComments) {
  const std::string quoted = "\"" + Replaced(Replaced(kPlain, ",", "\",\""), "\n", "\"\n\"");
  ExpectSameSamples(Read(quoted.substr(0, quoted.size() - 1)), Read(kPlain));
  ExpectPlain("# a paint\n# " + kPlain, "a header in a comment, degrees, f in 1/sr");
  ExpectPlain("% " + Replaced(kPlain, ",", " "),
              "a header in a comment, blanks, degrees, f in 1/sr");
  ExpectPlain("Goniometer 7\nsample: a paint, on steel\n\n" + kPlain,
              "2 lines before the header, degrees, f in 1/sr");
}

TEST(TextTable, UnitsAndOtherNames) {
  const std::string rows = kPlain.substr(kPlain.find('\n'));
  ExpectPlain("theta_i [deg],phi_i [deg],theta_o [deg],phi_o [deg],r,g,b" + rows,
              "degrees, f in 1/sr");
  ExpectPlain("Theta_i_deg,Phi_i_deg,Theta_o_deg,Phi_o_deg,R [1/sr],G [1/sr],B [1/sr]" + rows,
              "degrees, f in 1/sr");
  ExpectPlain("θi (°),φi (°),θr (°),φr (°),brdf_r,brdf_g,brdf_b" + rows,
              "'θr (°)' as theta_o, 'φr (°)' as phi_o, 'brdf_r' as r, 'brdf_g' as g, 'brdf_b' as "
              "b, degrees, f in 1/sr");
  ExpectPlain("theta_i,phi_i,theta_o,phi_o,r,g,b\ndeg,deg,deg,deg,1/sr,1/sr,1/sr" + rows,
              "degrees, f in 1/sr");
  ExpectPlain("theta_i [deg] phi_i [deg] theta_o [deg] phi_o [deg] r g b" + rows,
              "degrees, f in 1/sr");
  const Measurement radians =
      Read("theta_i (rad),phi_i (rad),theta_o_rad,phi_o_rad,r,g,b\n0.5,0,1.25,3,1,2,3\n");
  EXPECT_EQ(radians.samples.directions[0].theta_o, 1.25);
  EXPECT_THAT(radians.notes, ElementsAre("read as: radians, f in 1/sr"));
}

TEST(TextTable, NamesOfAngles) {
  const auto role = [](const char* name) { return ColumnNamed(name).role; };
  for (const char* name :
       {"theta_i", "THETAI", "theta_in", "incident_theta", "inc", "ti", "AOI",
        "Angle of incidence [deg]", "theta (incident)", "\\theta_i", "zenith_in"}) {
    EXPECT_EQ(role(name), ColumnRole::kThetaI) << name;
  }
  for (const char* name :
       {"theta_o", "theta_r", "thetar", "theta_s", "ThetaView", "outgoing_theta", "scatter angle",
        "to", "theta_out(rad)", "sensor zenith", "detector theta"}) {
    EXPECT_EQ(role(name), ColumnRole::kThetaO) << name;
  }
  for (const char* name : {"phi_i", "phiin", "Azimuth_in", "phi_inc_deg", "az_i"}) {
    EXPECT_EQ(role(name), ColumnRole::kPhiI) << name;
  }
  for (const char* name : {"phi_o", "phir", "azimuth_out", "phi_s"}) {
    EXPECT_EQ(role(name), ColumnRole::kPhiO) << name;
  }
  for (const char* name :
       {"brdf", "BSDF [1/sr]", "f", "f_r", "rho", "value", "brdf value", "brdf_1/sr"}) {
    EXPECT_EQ(role(name), ColumnRole::kValue) << name;
  }
  for (const char* name : {"index", "", "time", "theta_h", "sigma", "thetaphi", "no. 5"}) {
    EXPECT_EQ(role(name), ColumnRole::kOther) << name;
  }
  for (const char* name :
       {"550", "550nm", "550 nm", "0.55um", "0.55 [µm]", "brdf_550", "λ=550nm"}) {
    EXPECT_EQ(role(name), ColumnRole::kBand) << name;
    EXPECT_NEAR(ColumnNamed(name).wavelength, 550, 1e-9) << name;
  }
}

// 10 MB of commas are refused before they are a gigabyte of cells.
TEST(TextTable, ALineHasABoundedNumberOfCells) {
  const std::string commas(300000, ','), table = "theta_i,theta_o,f\n5,10,1\n";
  for (const std::string& text : {commas, "notes\n" + commas + "\n", table + commas}) {
    EXPECT_THAT(ReadError(text), IsError(ErrorKind::kLimit, {.key = "columns"}));
  }
  EXPECT_THAT(ReadError(table + commas, {.columns = "theta_i,theta_o,f"}),
              IsError(ErrorKind::kLimit, {.file = "x.csv", .line = 3, .key = "columns"}));
}

TEST(TextTable, ColumnsThatAreNoneOfIts) {
  const Measurement read = Read(
      ",name,theta_i,phi_i,theta_o,phi_o,r,g,b,\n1,a,5,0,0,0,1,2,3,\n2,\"b, c\",5,0,10,0,4,5,6,\n");
  EXPECT_EQ(read.samples.rho, (std::vector<Rgb>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_THAT(read.notes, ElementsAre("read as: degrees, f in 1/sr; left out: '', 'name'"));
}

TEST(TextTable, AnIndexNeedsNoName) {
  for (const std::string separator : {",", "\t", ";"}) {
    const std::string text = ",theta_i,phi_i,theta_o,phi_o,r,g,b\n0,5,0,0,0,1,2,3\n";
    EXPECT_EQ(Read(Replaced(text, ",", separator), {}, "x.tsv").samples.rho,
              (std::vector<Rgb>{{1, 2, 3}}))
        << separator;
  }
}

TEST(TextTable, OneValueCountsForAllChannels) {
  const Measurement read = Read("theta_i,phi_i,theta_o,phi_o,brdf\n5,0,0,0,0.25\n5,0,9,0,NA\n");
  EXPECT_EQ(read.samples.rho, (std::vector<Rgb>{{0.25, 0.25, 0.25}}));
  EXPECT_EQ(read.counts.missing, 1);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("one value for all channels, f in 1/sr")));
}

TEST(TextTable, WavelengthsBecomeColours) {
  const std::vector<double> wavelengths = {400, 450, 500, 550, 600, 650, 700};
  const std::vector<double> spectrum = {0.1, 0.2, 0.3, 0.4, 0.5, 0.4, 0.3};
  const Rgb expected = SpectralColor(wavelengths, "x")(spectrum);
  for (const char* header :
       {"400,450,500,550,600,650,700", "400nm,450nm,500nm,550nm,600nm,650nm,700nm",
        "0.4um,0.45um,0.5um,0.55um,0.6um,0.65um,0.7um"}) {
    const Measurement read = Read(std::string("theta_i,phi_i,theta_o,phi_o,") + header +
                                  "\n5,0,10,0,.1,.2,.3,.4,.5,.4,.3\n");
    EXPECT_EQ(read.samples.rho, (std::vector<Rgb>{expected})) << header;
    EXPECT_THAT(
        read.notes,
        ElementsAre("read as: degrees, 7 wavelengths to RGB by CIE 1931 (--bands picks some), f in "
                    "1/sr"));
  }
  const Measurement turned = Read(
      "700,650,600,550,500,450,400,phi_o,theta_o,phi_i,theta_i\n.3,.4,.5,.4,.3,.2,.1,0,10,0,5\n");
  EXPECT_EQ(turned.samples.rho, (std::vector<Rgb>{expected}));
  EXPECT_THAT(ReadError("theta_i,phi_i,theta_o,phi_o,450,550,650\n1,0,1,0,1,1,1\n"),
              IsError(ErrorKind::kMissing, {.key = "wavelengths", .value = "550"}));
  EXPECT_THAT(Read("theta_i,phi_i,theta_o,phi_o,532nm\n5,0,10,0,.5\n").notes,
              ElementsAre(HasSubstr("one value for all channels")));
  EXPECT_THAT(ReadError("theta_i,theta_o,phi_o,wavelength,r,g,b\n1,1,0,500,1,1,1\n"
                        "1,1,0,510,1,1,1\n"),
              IsError(ErrorKind::kUnsupported, {.line = 3, .key = "wavelength", .value = "510"}));
}

TEST(TextTable, BandsPicksWavelengths) {
  const std::string text =
      "theta_i,phi_i,theta_o,phi_o,400,450,500,550,600,650,700\n"
      "5,0,10,0,.1,.2,.3,.4,.5,.6,.7\n5,0,20,0,-1,.3,.3,.4,.5,.6,.7\n";
  const auto read = [&](const std::string& bands) { return Read(text, {.bands = bands}); };
  for (const std::string order : {"450,550,650", "650nm, 550, 450"}) {
    const Measurement three = read(order);
    EXPECT_EQ(three.samples.rho, (std::vector<Rgb>{{.6, .4, .2}, {.6, .4, .3}}));
    EXPECT_EQ(three.samples.spectra, nullptr);
    EXPECT_THAT(three.notes,
                ElementsAre(HasSubstr("650, 550, 450 nm of 7 wavelengths as r, g, b")));
  }
  const Measurement one = read("550.3");
  EXPECT_EQ(one.samples.rho, (std::vector<Rgb>{{.4, .4, .4}, {.4, .4, .4}}));
  EXPECT_EQ(one.samples.spectra->wavelengths, (std::vector<double>{550}));
  EXPECT_THAT(one.notes,
              ElementsAre(HasSubstr("one value for all channels, 550 nm of 7 wavelengths")));
  // Bands that are not asked for do not count: the invalid value at 400 nm is ignored.
  const std::vector<double> five = {450, 500, 550, 600, 650};
  const Measurement some = read("450,500,550,600,650");
  EXPECT_EQ(some.samples.rho[0], SpectralColor(five, "x")(std::vector<double>{.2, .3, .4, .5, .6}));
  EXPECT_EQ(some.samples.spectra->wavelengths, five);
  EXPECT_EQ(some.samples.size(), 2);
  EXPECT_EQ(read("").samples.size(), 1);
  EXPECT_EQ(Read(kPlain, {.bands = "550"}).notes,
            (std::vector<std::string>{"--bands is of spectra, and changes nothing here"}));
  // A band beside a colour can be chosen, too.
  EXPECT_EQ(
      Read("theta_i,theta_o,phi_o,r,g,b,940nm\n5,10,0,1,2,3,.25\n", {.bands = "940"}).samples.rho,
      (std::vector<Rgb>{{.25, .25, .25}}));

  const auto error = [&](const std::string& bands) { return ReadError(text, {.bands = bands}); };
  EXPECT_THAT(error("532"),
              IsError(ErrorKind::kMissing, {.file = "x.csv", .key = "bands", .value = "532"}));
  EXPECT_THAT(error("550,550.2,600"),
              IsError(ErrorKind::kConflict, {.file = "x.csv", .key = "bands", .value = "550"}));
  EXPECT_THAT(error("400,500,600,700"),
              IsError(ErrorKind::kMissing, {.key = "wavelengths", .value = "500"}));
  for (const std::string bad : {"500,600", "500,500,600", "green", "-1", "nan", "500,"}) {
    EXPECT_THAT(error(bad), IsError(ErrorKind::kFormat, {.key = "bands", .value = bad})) << bad;
  }
  std::string many = "theta_i,theta_o,phi_o", row = "5,10,0";
  for (int k = 400; k <= 700; k += 10) {
    many += "," + std::to_string(k) + "nm";
    row += ",1";
  }
  EXPECT_THAT(ReadError(many + "\n" + row + "\n", {.bands = "532"}),
              IsError(ErrorKind::kMissing, {.key = "bands", .value = "532"}));
}

TEST(TextTable, ARowAWavelengthMakesSpectra) {
  const std::string header = "theta_i,theta_o,phi_o,wavelength [nm],f\n";
  const auto row = [](int theta_o, const std::string& wavelength, const std::string& f) {
    return "5," + std::to_string(theta_o) + ",180," + wavelength + "," + f + "\n";
  };
  std::string by_direction = header, by_wavelength = header;
  const std::vector<double> wavelengths = {400, 450, 500, 550, 600, 650, 700};
  for (const int theta_o : {10, 20}) {
    for (int k = 0; k < 7; ++k) {
      by_direction += row(theta_o, std::to_string(400 + 50 * k), "0." + std::to_string(k + 1));
    }
  }
  for (int k = 6; k >= 0; --k) {
    for (const int theta_o : {10, 20}) {
      by_wavelength += row(theta_o, std::to_string(400 + 50 * k), "0." + std::to_string(k + 1));
    }
  }
  const Rgb expected =
      SpectralColor(wavelengths, "x")(std::vector<double>{.1, .2, .3, .4, .5, .6, .7});
  for (const std::string& text : {by_direction, by_wavelength}) {
    const Measurement read = Read(text);
    EXPECT_EQ(read.samples.rho, (std::vector<Rgb>{expected, expected}));
    EXPECT_EQ(read.samples.spectra->wavelengths, wavelengths);
    EXPECT_THAT(read.notes, ElementsAre(HasSubstr("a row a wavelength, 7 wavelengths to RGB")));
  }
  EXPECT_EQ(Read(by_direction, {.bands = "650,550,450"}).samples.rho[1], (Rgb{.6, .4, .2}));
  // A direction once more is another sample, and one without a wavelength is missing.
  const std::string once_more = by_direction + row(10, "550", "0.9") + row(30, "500", "NA");
  EXPECT_EQ(Read(once_more, {.bands = "550"}).samples.rho,
            (std::vector<Rgb>{{.4, .4, .4}, {.4, .4, .4}, {.9, .9, .9}}));
  const Measurement all = Read(once_more);
  EXPECT_EQ(all.samples.size(), 2);
  EXPECT_EQ(all.counts.missing, 1);
  const Measurement in_um =
      Read("theta_i,theta_o,phi_o,lambda,f\n5,10,0,0.532,.5\n5,20,0,0.532,.25\n");
  EXPECT_EQ(in_um.samples.spectra->wavelengths, (std::vector<double>{532}));
  EXPECT_THAT(ReadError(header + row(10, "0", "1")),
              IsError(ErrorKind::kRange, {.line = 2, .key = "wavelength [nm]", .value = "0"}));
}

// A lobe about the mirror direction in the plane of incidence.
std::string InPlane(const std::string& header, double sign, bool has_phi) {
  std::string text = header + "\n";
  for (int theta_i = 10; theta_i <= 50; theta_i += 20) {
    for (int theta_o = -60; theta_o <= 60; theta_o += 5) {
      const double f = 0.1 + std::exp(-0.01 * std::pow(theta_o - theta_i, 2));
      text += std::to_string(theta_i) + (has_phi ? ",0," : ",") +
              std::to_string(static_cast<int>(sign) * theta_o) + (has_phi ? ",0," : ",") +
              std::to_string(f) + "\n";
    }
  }
  return text;
}

TEST(TextTable, SignsInThePlaneOfIncidence) {
  for (const bool has_phi : {false, true}) {
    const std::string header = has_phi ? "theta_i,phi_i,theta_o,phi_o,f" : "theta_i,theta_o,f";
    const std::string end = ", as its samples say, one value for all channels, f in 1/sr";
    const Measurement forward = Read(InPlane(header, 1, has_phi));
    EXPECT_THAT(forward.notes,
                ElementsAre(HasSubstr("theta_o > 0 on the side of the mirror direction" + end)));
    const Measurement backward = Read(InPlane(header, -1, has_phi));
    EXPECT_THAT(backward.notes,
                ElementsAre(HasSubstr("theta_o > 0 on the side of the light" + end)));
    for (const Measurement& read : {forward, backward}) {
      EXPECT_FALSE(read.anisotropic);
      for (int j = 0; j < read.samples.size(); ++j) {
        const SphericalAngles& at = read.samples.directions[j];
        const bool is_mirror = std::abs(std::remainder(at.phi_o - at.phi_i, 2 * kPi)) > 3;
        const double theta_o = RadiansToDegrees(is_mirror ? at.theta_o : -at.theta_o);
        EXPECT_NEAR(read.samples.rho[j][0],
                    0.1 + std::exp(-0.01 * std::pow(theta_o - RadiansToDegrees(at.theta_i), 2)),
                    1e-6);
      }
    }
  }
}

TEST(TextTable, ANegativeThetaIsTheOtherSide) {
  ExpectSameSamples(
      Read("theta_i,phi_i,theta_o,phi_o,r,g,b\n10,0,-20,0,1,2,3\n10,0,-30,90,4,5,6\n"),
      Read("theta_i,phi_i,theta_o,phi_o,r,g,b\n10,0,20,180,1,2,3\n10,0,30,270,4,5,6\n"));
  // The light of both sides of one plane shows nothing of a grain.
  const Measurement both =
      Read("theta_i,phi_i,theta_o,phi_o,r,g,b\n-10,0,20,90,1,2,3\n10,0,20,-90,1,2,3\n");
  EXPECT_FALSE(both.anisotropic);
  EXPECT_NEAR(std::abs(both.samples.directions[0].phi_i), kPi, 1e-12);
}

TEST(TextTable, AnglesThatHaveNoColumn) {
  const SourceOptions at_30 = {.theta_i_deg = 30};
  const Measurement given = Read("theta_o,phi_o,r,g,b\n20,180,1,2,3\n", at_30);
  ExpectSameSamples(given, Read("theta_i,phi_i,theta_o,phi_o,r,g,b\n30,0,20,180,1,2,3\n"));
  EXPECT_THAT(given.notes, ElementsAre("read as: degrees, theta_i = 30 deg, phi_i = 0, f in 1/sr"));
  const Measurement in_plane = Read("angle;brdf\n20;1\n-20;0,5\n", at_30, "x.txt");
  ExpectSameSamples(in_plane,
                    Read("theta_i,phi_i,theta_o,phi_o,f\n30,0,20,180,1\n30,0,20,0,0.5\n"));
  EXPECT_THAT(Read(kPlain, at_30).notes,
              ElementsAre(HasSubstr("--theta_i is of tables without a column theta_i")));
  EXPECT_THAT(ReadError("theta_o,phi_o,r,g,b\n20,180,1,2,3\n"),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "theta_i"}));
}

TEST(TextTable, ADetectorMayStandStill) {
  const SourceOptions at_45 = {.theta_o_deg = 45};
  const Measurement given = Read("theta_i,phi_o,r,g,b\n20,180,1,2,3\n", at_45);
  ExpectSameSamples(given, Read("theta_i,phi_i,theta_o,phi_o,r,g,b\n20,0,45,180,1,2,3\n"));
  EXPECT_THAT(given.notes, ElementsAre("read as: degrees, theta_o = 45 deg, phi_i = 0, f in 1/sr"));
  // An angle that the header does not tell is the other one; its signs are as those of theta_o.
  for (const char* const name : {"theta_i", "angle", "theta"}) {
    ExpectSameSamples(Read(std::string(name) + ";brdf\n20;1\n-20;0,5\n", at_45),
                      Read("theta_i,phi_i,theta_o,phi_o,f\n20,0,45,180,1\n-20,0,45,180,0.5\n"));
  }
  EXPECT_THAT(Read(kPlain, at_45).notes,
              ElementsAre(HasSubstr("--theta_o is of tables without a column theta_o")));
  EXPECT_THAT(ReadError("theta_i,phi_o,r,g,b\n20,180,1,2,3\n"),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "theta_o"}));
  EXPECT_THAT(ReadError(kPlain, {.theta_o_deg = 90}),
              IsError(ErrorKind::kRange, {.key = "theta_o", .value = "90"}));
}

TEST(TextTable, BothAnglesMayBeGiven) {
  const SourceOptions options = {.theta_i_deg = 10, .theta_o_deg = 45};
  const Measurement given = Read("phi_o,f\n180,1\n90,2\n", options);
  ExpectSameSamples(given, Read("theta_i,phi_i,theta_o,phi_o,f\n10,0,45,180,1\n10,0,45,90,2\n"));
  EXPECT_THAT(Source("synth:felt@2x4").Read(options).notes,
              ElementsAre(HasSubstr("--theta_i is of text tables"),
                          HasSubstr("--theta_o is of text tables")));
}

TEST(TextTable, ColumnsMayBeNamed) {
  const std::string rows = kPlain.substr(kPlain.find('\n') + 1);
  ExpectPlain(rows, "columns by --columns, degrees, f in 1/sr",
              {.columns = "theta_i,phi_i,theta_o,phi_o,r,g,b"});
  ExpectPlain("a;b;c;d;e;f;g\n" + Replaced(rows, ",", ";"),
              "1 line before the header, columns by --columns, semicolons, degrees, f in 1/sr",
              {.columns = "theta_i,phi_i,theta_o,phi_o,r,g,b"});
  const Measurement some = Read(kPlain, {.columns = "theta_i,phi_i,theta_o,phi_o,-,f,-"});
  EXPECT_EQ(some.samples.rho[0], (Rgb{0.5, 0.5, 0.5}));
  EXPECT_EQ(Read("20;1\n-20;0,5\n", {.columns = "theta_o,f", .theta_i_deg = 30}).counts.valid, 2);
  EXPECT_THAT(ReadError(rows, {}, "x.txt"),
              IsError(ErrorKind::kFormat, {.file = "x.txt", .line = 1}));
  EXPECT_THAT(ReadError("nothing\n", {.columns = "theta_i,theta_o,f"}),
              IsError(ErrorKind::kMissing, {.file = "x.csv", .key = "columns"}));
  EXPECT_THAT(Source("synth:felt@2x4").Read({.columns = "theta_i", .theta_i_deg = 3}).notes,
              ElementsAre(HasSubstr("--columns is of text tables, and changes nothing here"),
                          HasSubstr("--theta_i is of text tables")));
  EXPECT_THAT(ReadError(kPlain, {.theta_i_deg = 90}),
              IsError(ErrorKind::kRange, {.key = "theta_i", .value = "90"}));
}

TEST(TextTable, WhatNamesLeaveOpenIsAsked) {
  const std::string angles = "theta_i,phi_i,theta_o,phi_o";
  EXPECT_THAT(ReadError(angles + ",cheese\n1,0,1,0,1\n"),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "of values"}));
  EXPECT_THAT(ReadError(angles + ",brdf,rho\n1,0,1,0,1,1\n"),
              IsError(ErrorKind::kConflict, {.line = 1, .key = "brdf", .value = "rho"}));
  EXPECT_THAT(ReadError(angles + ",brdf [%]\n1,0,1,0,1\n"),
              IsError(ErrorKind::kUnsupported, {.line = 1, .key = "columns"}));
  EXPECT_THAT(
      ReadError("theta_i [mrad],phi_i,theta_o,phi_o,f\n1,0,1,0,1\n"),
      IsError(ErrorKind::kUnsupported, {.line = 1, .key = "theta_i [mrad]", .value = "mrad"}));
  EXPECT_THAT(ReadError(angles + ",f\n1,0,1,0,0,5\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "columns", .value = "6"}));
  EXPECT_THAT(ReadError("theta_i;theta_o;f\n1;1;1.000,5\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "f", .value = "1.000,5"}));
}

TEST(TextTable, ReadsTheSharedCases) {
  const std::string folder = MeasuredData("../cases/");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  const Measurement good = LoadMeasurement(folder + "good.csv");
  for (const char* name : {"semicolon_comma.csv", "tabs.csv", "units.csv"}) {
    ExpectSameSamples(LoadMeasurement(folder + name), good);
  }
  const Measurement mono = LoadMeasurement(folder + "mono.csv");
  const Measurement spectral = LoadMeasurement(folder + "spectral.csv");
  ASSERT_EQ(mono.samples.size(), good.samples.size());
  ASSERT_EQ(spectral.samples.size(), good.samples.size());
  for (int j = 0; j < good.samples.size(); ++j) {
    EXPECT_EQ(mono.samples.rho[j][2], good.samples.rho[j][0]);
  }
  EXPECT_THAT(LoadMeasurement(folder + "inplane_signed.csv").notes,
              ElementsAre(HasSubstr("theta_o > 0 on the side of the mirror direction")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
