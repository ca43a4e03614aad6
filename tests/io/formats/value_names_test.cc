// Names of values that hold f times something, of bands of satellites, of wavelengths and phases.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "io/formats/text/table_columns.h"
#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

Measurement Read(const std::string& text, const SourceOptions& options = {}) {
  return Source("x.csv", text).Read(options);
}

std::optional<Error> ReadError(const std::string& text, const SourceOptions& options = {}) {
  return ErrorOf([&] { Read(text, options); });
}

std::string Problem(const std::string& text) {
  const std::optional<Error> error = ReadError(text);
  return error ? error->what() : "";
}

std::string Advice(const std::string& name) {
  return Problem("theta_i,theta_o,phi_o," + name + "\n30,10,0,0.25\n");
}

TEST(ValueNames, PiTimesFIsNamed) {
  const std::string latin1 = std::string("Facteur de r\xE9") + "flexion";
  for (const char* const name :
       {"radiance factor", "luminance factor", "Leuchtdichtefaktor", "Strahldichtefaktor", "HDRF",
        "HCRF", "Reflexionsfaktor", "Facteur de r\u00E9flexion", latin1.c_str(), "beta", "pi f",
        "\u03C0f", "pi*BRDF", "brdf_times_pi"}) {
    EXPECT_THAT(Advice(name), HasSubstr("--columns=theta_i,theta_o,phi_o,f --scale=0.3183"))
        << name;
  }
  for (const char* const name : {"Reflexionsgrad", "Remission", "bidirectional reflectance"}) {
    EXPECT_THAT(ReadError(std::string("theta_i,theta_o,") + name + "\n30,10,0.25\n"),
                IsError(ErrorKind::kMissing, {.key = "scale", .value = name}));
  }
  EXPECT_EQ(Read("theta_i,theta_o,BRDF,pi f\n30,10,1,3.14\n").samples.rho[0][0], 1);
}

TEST(ValueNames, TimesACosineIsNamed) {
  for (const char* const name :
       {"ARS", "ARS [1/sr]", "DSF", "CCBRDF", "BRDF*cos", "f_r cos(theta_o)", "cos BRDF"}) {
    EXPECT_THAT(Advice(name), HasSubstr("--columns=theta_i,theta_o,phi_o,f --cosine=o:1")) << name;
  }
  EXPECT_THAT(Advice("f cos(theta_i)"), HasSubstr("phi_o,f --cosine=1"));
  EXPECT_THAT(Advice("BDR"), HasSubstr("phi_o,f --cosine=1"));
  EXPECT_THAT(Advice("BRDF/cos"), HasSubstr("phi_o,f --cosine=o:-1"));
  EXPECT_EQ(Read("theta_i,theta_o,BRDF mean\n30,10,1\n").samples.size(), 1);
}

TEST(ValueNames, TheFirstElementOfAMuellerMatrixIsF) {
  EXPECT_THAT(Problem("theta_i,theta_o,m00,m01,m10,m11\n30,10,1,0,0,1\n"),
              HasSubstr("--columns=theta_i,theta_o,f,-,-,-"));
  for (const char* const name : {"mueller00", "f11", "S0"}) {
    EXPECT_THAT(Advice(name), HasSubstr("type --columns=theta_i,theta_o,phi_o,f")) << name;
  }
}

TEST(ValueNames, BandsOfSatellitesAreAskedWithTheirScale) {
  const std::string rows = "\n30,10,0.25,0.5,1\n";
  EXPECT_THAT(Problem("SZA;VZA;B2;B3;B4\n30;10;0,25;0,5;1\n"),
              AllOf(HasSubstr("of Sentinel-2, and reflectance factors, pi f, type "
                              "--columns=theta_i,theta_o,490nm,560nm,665nm --bands=665,560,490 "
                              "--scale=0.3183"),
                    HasSubstr("; if of MODIS, type ")));
  EXPECT_THAT(Problem("sza,vza,MODIS_B1,MODIS_B2,MODIS_B4" + rows),
              AllOf(HasSubstr("645nm,859nm,555nm --bands=859,645,555 --scale=0.3183"),
                    Not(HasSubstr("Sentinel"))));
  EXPECT_THAT(Problem("sza,vza,S2_B02,S2_B03,S2_B04\n30,10,1204,2100,10000\n"),
              HasSubstr("665nm --bands=665,560,490 --scale=3.183e-5"));
  // Wavelengths beside angles of the sun are reflectances, too, and beside theta_i they are f.
  EXPECT_THAT(ReadError("sza,vza,450,550,650" + rows, {.bands = "650,550,450"}),
              IsError(ErrorKind::kMissing, {.key = "scale"}));
  EXPECT_EQ(Read("theta_i,theta_o,450,550,650" + rows, {.bands = "650,550,450"}).samples.size(), 1);
}

TEST(ValueNames, WavelengthsHaveNamesAndUnits) {
  for (const char* const name :
       {"wavelength_um", "wavelength (\u00B5m)", "wavelength [micron]", "wl_um", "lambda_um"}) {
    EXPECT_THAT(Read(std::string(name) + ",theta_i,theta_o,f\n0.5,30,10,1\n0.55,30,10,1\n",
                     {.bands = "550"})
                    .samples.spectra->wavelengths,
                ElementsAre(550))
        << name;
  }
  const std::string latin1 = std::string("Wellenl\xE4") + "nge [nm]";
  for (const char* const name :
       {"wl_nm", "Wellenl\u00E4nge (nm)", latin1.c_str(), "longueur d'onde (nm)", "lambda_nm"}) {
    EXPECT_THAT(
        Read(std::string(name) + ";theta_i;theta_o;f\n500;30;10;1\n550;30;10;1\n", {.bands = "550"})
            .samples.spectra->wavelengths,
        ElementsAre(550))
        << name;
  }
  EXPECT_NEAR(
      Read("wavelength_m,theta_i,theta_o,f\n5e-7,30,10,1\n5.5e-7,30,10,1\n", {.bands = "550"})
          .samples.spectra->wavelengths[0],
      550, 1e-9);
  EXPECT_THAT(Problem("wavenumber (cm-1),theta_i,theta_o,f\n1000,30,10,1\n2000,30,10,1\n"),
              HasSubstr("10,000,000 divided by the wavenumber"));
}

TEST(ValueNames, ThePhaseBesideIncidenceAndEmission) {
  const Measurement alpha = Read("i,e,alpha,f\n30,0,30,1\n30,30,60,1\n");
  EXPECT_NEAR(alpha.samples.directions[1].phi_o, kPi, 1e-6);
  const Measurement phi = Read("i,e,phi,f\n30,0,30,1\n30,30,60,1\n40,0,40,1\n");
  EXPECT_NEAR(phi.samples.directions[1].phi_o, kPi, 1e-6);
  EXPECT_THAT(phi.notes[0], HasSubstr("'phi' as the phase"));
  // An azimuth is not the other angle there.
  EXPECT_NEAR(Read("i,e,phi,f\n30,0,0,1\n30,30,60,1\n40,0,40,1\n").samples.directions[1].phi_o,
              kPi / 3, 1e-9);
}

TEST(ValueNames, TheFirstOfTwoAnglesIsTheIncidence) {
  for (const std::string head : {"theta1,theta2,phi,f", "\u03B81,\u03B82,\u0394\u03C6,f"}) {
    const Measurement read = Read(head + "\n30,10,90,1\n");
    EXPECT_NEAR(read.samples.directions[0].theta_i, kPi / 6, 1e-9);
    EXPECT_NEAR(read.samples.directions[0].phi_o, kPi / 2, 1e-9);
  }
  EXPECT_EQ(Read("AOI,AOS,f\n30,10,1\n").samples.size(), 1);
  EXPECT_EQ(ColumnNamed("theta1").role, ColumnRole::kOther);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
