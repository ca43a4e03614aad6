// Columns of values by their names.
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

using testing::ElementsAre;
using testing::HasSubstr;

Measurement Read(const std::string& text, const SourceOptions& options = {}) {
  return Source("x.csv", text).Read(options);
}

std::optional<Error> ReadError(const std::string& text, const SourceOptions& options = {}) {
  return ErrorOf([&] { Read(text, options); });
}

TEST(ValueColumns, AReflectanceIsAskedWhetherItIsPiF) {
  const auto rows = [](const std::string& name) {
    return "theta_i,theta_o,phi_o," + name + "\n30,10,0,0.5\n30,10,90,0.5\n30,10,180,0.5\n";
  };
  for (const char* const name : {"Reflectance", "rho", "refl", "R", "reflectance_550nm", "R550",
                                 "band_865", "Reflectance [-]"}) {
    EXPECT_THAT(ReadError(rows(name)),
                IsError(ErrorKind::kMissing, {.file = "x.csv", .line = 1, .key = "scale"}))
        << name;
    EXPECT_NEAR(Read(rows(name), {.scale = 0.3183}).samples.rho[0][1], 0.15915, 1e-9);
    EXPECT_EQ(Read(rows(name), {.scale = 1}).samples.rho[0][1], 0.5);
    EXPECT_EQ(Read(rows(name), {.columns = "theta_i,theta_o,phi_o,f"}).samples.rho[0][1], 0.5);
  }
  EXPECT_THAT(ReadError(rows("rho")),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "scale", .value = "rho"}));
  EXPECT_THAT(ReadError("theta_i,theta_o,rho_r,rho_g,rho_b\n30,10,1,1,1\n"),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "scale", .value = "rho_r"}));
  EXPECT_THAT(ReadError(rows("x"), {.columns = "theta_i,theta_o,phi_o,rho"}),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "scale", .value = "rho"}));
}

TEST(ValueColumns, AValueInInverseSteradianIsNotAsked) {
  for (const char* const name : {"BRDF", "f", "f_r", "value", "rho [1/sr]", "reflectance (sr^-1)",
                                 "rho_1/sr", "R [1/sr]", "rho_brdf", "550nm", "brdf_550"}) {
    EXPECT_EQ(Read(std::string("theta_i,theta_o,phi_o,") + name + "\n30,10,0,0.5\n").samples.size(),
              1)
        << name;
  }
  EXPECT_EQ(Read("x\n30,10,0.5\n", {.columns = "theta_i,theta_o,r"}).samples.size(), 1);
}

TEST(ValueColumns, PolarisationsMakeOneValue) {
  const std::string rows = "\n30,10,0,1,0.25,0.25,0.5\n";
  for (const std::string names :
       {"f_ss,f_sp,f_ps,f_pp", "ss,sp,ps,pp", "BRDF_pp,BRDF_ps,BRDF_sp,BRDF_ss"}) {
    const Measurement read = Read("theta_i,theta_o,phi_o," + names + rows);
    EXPECT_EQ(read.samples.rho, (std::vector<Rgb>{{1, 1, 1}})) << names;
    EXPECT_THAT(read.notes, ElementsAre(HasSubstr("half the sum of '" + names.substr(0, 2))));
  }
  EXPECT_EQ(Read("theta_i,theta_o,BRDF_s,BRDF_p\n30,10,1,0.5\n").samples.rho[0][2], 0.75);
  EXPECT_EQ(Read("theta_i,theta_o,Rs,Rp\n30,10,1,0.5\n", {.scale = 0.5}).samples.rho[0][2], 0.375);
  EXPECT_THAT(ReadError("theta_i,theta_o,Rs,Rp\n30,10,1,0.5\n"),
              IsError(ErrorKind::kMissing, {.key = "scale", .value = "Rs"}));
  // One of two, and beside f.
  EXPECT_THAT(ReadError("theta_i,theta_o,BRDF_s\n30,10,1\n"), testing::Optional(testing::_));
  EXPECT_EQ(Read("theta_i,theta_o,f,f_s,f_p\n30,10,1,0.5,0\n").samples.rho[0][0], 1);
}

TEST(ValueColumns, NamesOfSatellites) {
  const Measurement read = Read(
      "solar_zn,solar_az,sensor_zn,sensor_az,band_865\n20,135,10,165,0.5\n", {.scale = 0.3183});
  EXPECT_NEAR(RadiansToDegrees(read.samples.directions[0].theta_i), 20, 1e-9);
  EXPECT_NEAR(RadiansToDegrees(read.samples.directions[0].phi_o), 165, 1e-9);
  EXPECT_EQ(read.samples.spectra->wavelengths, (std::vector<double>{865}));
  EXPECT_THAT(ReadError("sza,vza,I/F\n20,10,0.5\n"),
              IsError(ErrorKind::kUnsupported, {.line = 1, .key = "columns"}));
}

TEST(ValueColumns, AColumnOfValuesMayHaveWordsBehindBrdf) {
  EXPECT_EQ(Read("theta_i,theta_o,brdf_data_1D\n20,10,0.5\n").samples.rho[0][0], 0.5);
  EXPECT_THAT(ReadError("theta_i,theta_o,brdf_mean,brdf_std\n20,10,0.5,1\n"),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "of values"}));
}

TEST(ValueColumns, ASignIsNoPartOfAWavelength) {
  for (const std::string name : {"-550nm", "\u2212550", "lambda=-550nm"}) {
    EXPECT_EQ(ColumnNamed(name).role, ColumnRole::kOther) << name;
  }
  EXPECT_EQ(ColumnNamed("brdf-550nm").wavelength, 550);
  EXPECT_THAT(ReadError("theta_i,theta_o,-550nm\n5,10,1\n"),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "of values"}));
  const Measurement measured = Read("theta_i,theta_o,-450nm,550nm\n5,10,1,2\n");
  EXPECT_THAT(measured.samples.rho, ElementsAre(Rgb{2, 2, 2}));
  EXPECT_THAT(measured.notes.front(), HasSubstr("left out: '-450nm'"));
}

TEST(ValueColumns, AWavelengthMayNotStandTwice) {
  const std::string text = "theta_i,theta_o,550nm,0.55um,650nm\n5,10,1,2,3\n";
  for (const char* const bands : {"", "550"}) {
    EXPECT_THAT(ReadError(text, {.bands = bands}),
                IsError(ErrorKind::kConflict, {.line = 1, .key = "550nm", .value = "0.55um"}));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
