// Columns that --columns names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Measurement Read(const std::string& text, const SourceOptions& options) {
  return Source("x.txt", text).Read(options);
}

std::optional<Error> ReadError(const std::string& text, const SourceOptions& options) {
  return ErrorOf([&] { Read(text, options); });
}

const std::string kRows = "a,30,7,10,0.25\nb,30,8,20,0.5\n";
const std::string kTable = "Operator,InAngle,T [K],OutAngle [deg],Value\n" + kRows;

TEST(NamedColumns, AHeaderTellsWhichTheyAre) {
  for (const std::string& text : {kTable, "# a paint\n# " + kTable, "Goniometer 7\n" + kTable}) {
    const Measurement read = Read(text, {.columns = "f=Value,theta_i=InAngle,theta_o=outangle"});
    ASSERT_EQ(read.samples.rho, (std::vector<Rgb>{{0.25, 0.25, 0.25}, {0.5, 0.5, 0.5}})) << text;
    EXPECT_NEAR(RadiansToDegrees(read.samples.directions[1].theta_i), 30, 1e-12);
    EXPECT_NEAR(RadiansToDegrees(read.samples.directions[1].theta_o), 20, 1e-12);
    EXPECT_THAT(read.notes, ElementsAre(HasSubstr("left out: 'Operator', 'T [K]'")));
    EXPECT_THAT(read.notes, ElementsAre(HasSubstr("columns by --columns, 'InAngle' as theta_i")));
  }
}

TEST(NamedColumns, TheOthersKeepTheMeaningOfTheirNames) {
  const Measurement read =
      Read("aoi,theta_o (rad),Az,x,g\n30,0.5,90,0.25,0.5\n", {.columns = "f=x"});
  ASSERT_EQ(read.samples.rho, (std::vector<Rgb>{{0.25, 0.25, 0.25}}));
  EXPECT_EQ(read.samples.directions[0].theta_o, 0.5);
  EXPECT_NEAR(RadiansToDegrees(read.samples.directions[0].phi_o), 90, 1e-12);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("left out: 'g'")));
  // A column that is named takes the place of another.
  EXPECT_EQ(Read("theta_i,theta_o,theta_2,BRDF\n30,10,20,1\n", {.columns = "theta_o=theta_2"})
                .samples.directions[0]
                .theta_o,
            DegreesToRadians(20));
  EXPECT_EQ(Read("theta_i,theta_o,raw,BRDF\n30,10,20,1\n", {.columns = "f=raw"}).samples.rho[0][0],
            20);
  // What the header calls R is asked, unless the flag names it.
  const std::string of_r = "theta_i,out,R\n30,10,1\n";
  EXPECT_THAT(ReadError(of_r, {.columns = "theta_o=out"}),
              IsError(ErrorKind::kMissing, {.key = "scale", .value = "R"}));
  EXPECT_EQ(Read(of_r, {.columns = "theta_o=out,f=R"}).samples.size(), 1);
}

TEST(NamedColumns, UnitsOfTheHeaderCount) {
  const Measurement read = Read("In (rad);Out_rad;Value [dB]\n0.5;0.25;10\n",
                                {.columns = "theta_i=In,theta_o=Out_rad,f=Value"});
  EXPECT_EQ(read.samples.directions[0].theta_i, 0.5);
  EXPECT_EQ(read.samples.directions[0].theta_o, 0.25);
  EXPECT_EQ(read.samples.rho[0][0], 10);
}

TEST(NamedColumns, AFlagSaysThatAReflectanceIsF) {
  EXPECT_EQ(Read("theta_i,theta_o,Reflectance\n30,10,0.25\n",
                 {.columns = "theta_i,theta_o,f=Reflectance"})
                .samples.rho[0][0],
            0.25);
}

TEST(NamedColumns, WhatTheHeaderHasNotIsTold) {
  EXPECT_THAT(ReadError(kTable, {.columns = "theta_i=InAngel,theta_o=OutAngle,f=Value"}),
              IsError(ErrorKind::kUnknown,
                      {.file = "x.txt", .line = 1, .key = "columns", .value = "InAngel"}));
  EXPECT_THAT(ReadError(kTable, {.columns = "theta_i=a,f=b"}),
              IsError(ErrorKind::kMissing, {.file = "x.txt", .key = "columns", .value = "a"}));
  EXPECT_THAT(ReadError(kTable, {.columns = "theta_i=InAngle,theta_o=InAngle,f=Value"}),
              IsError(ErrorKind::kConflict, {.line = 1, .key = "columns", .value = "theta_o"}));
  EXPECT_THAT(ReadError("In,In,f\n1,2,3\n", {.columns = "theta_i=In,f=f"}),
              IsError(ErrorKind::kConflict, {.line = 1, .key = "columns", .value = "In"}));
  EXPECT_THAT(ReadError(kTable, {.columns = "theta_i=,f=Value"}),
              IsError(ErrorKind::kUnknown, {.key = "columns", .value = "theta_i="}));
  EXPECT_THAT(ReadError(kTable, {.columns = "theta_i=InAngle,f=Value"}),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "theta_o"}));
}

// 30 and 10 degrees from the normal.
TEST(NamedColumns, ElevationsAreNinetyDegreesMinusTheta) {
  const std::string rows = "60,80,0,0.25\n90,45,0,0.5\n";
  for (const std::string names :
       {"sun elevation,view elevation,raa", "elevation_i [deg],elevation_o,dphi",
        "Solar Altitude,Sensor Altitude,relative azimuth"}) {
    const Measurement read = Read(names + ",BRDF\n" + rows, {});
    ASSERT_EQ(read.samples.size(), 2) << names;
    EXPECT_NEAR(RadiansToDegrees(read.samples.directions[0].theta_i), 30, 1e-9);
    EXPECT_NEAR(RadiansToDegrees(read.samples.directions[0].theta_o), 10, 1e-9);
    EXPECT_EQ(read.samples.directions[1].theta_i, 0);
  }
  EXPECT_THAT(Read("sun elevation,view elevation,raa,f\n" + rows, {}).notes,
              ElementsAre(HasSubstr("'sun elevation' as 90 deg minus theta_i")));
  EXPECT_THAT(
      Read("In,Out,dphi,f\n" + rows, {.columns = "elevation_i=In,elevation_o=Out,phi_o=dphi,f=f"})
          .samples.directions[1]
          .theta_o,
      testing::DoubleNear(kPi / 4, 1e-12));
  // Arms of a goniometer may be said to have an elevation from the normal.
  EXPECT_THAT(ReadError("source elevation,detector elevation,f\n-60,20,1\n", {}),
              IsError(ErrorKind::kRange, {.line = 2, .key = "source elevation", .value = "-60"}));
}

TEST(NamedColumns, AnAzimuthMayRunAboutTheMirrorDirection) {
  // 20 degrees towards the normal, 20 beyond the mirror direction, and 20 across.
  const Measurement read = Read("theta_i,theta_o,phi_o,f\n30,20,0,1\n30,20,180,1\n30,20,90,1\n",
                                {.columns = "theta_i=theta_i,from_mirror=theta_o,phi_o=phi_o,f=f"});
  ASSERT_EQ(read.samples.size(), 3);
  const auto& at = read.samples.directions;
  EXPECT_NEAR(RadiansToDegrees(at[0].theta_o), 10, 1e-9);
  EXPECT_NEAR(RadiansToDegrees(at[1].theta_o), 50, 1e-9);
  for (int j = 0; j < 2; ++j) EXPECT_NEAR(RadiansToDegrees(at[j].phi_o), 180, 1e-9);
  const DirectionPair across = ToDirections(at[2]), beyond = ToDirections(at[1]);
  const Direction mirror = ToDirection({DegreesToRadians(30), kPi});
  EXPECT_NEAR(Dot(across.wo, mirror), std::cos(DegreesToRadians(20)), 1e-12);
  EXPECT_NEAR(across.wo[2], std::cos(DegreesToRadians(30)) * std::cos(DegreesToRadians(20)), 1e-12);
  EXPECT_NEAR(Dot(beyond.wo, mirror), std::cos(DegreesToRadians(20)), 1e-12);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("phi_o as the azimuth about it")));
}

TEST(NamedColumns, AnUnknownNameIsRefused) {
  const std::string known = "' says of no column what it holds; known are theta_i, phi_i";
  EXPECT_THAT(ReadError("a,b\n1,2\n3,4\n", {.columns = "a,b"}),
              IsError(ErrorKind::kUnknown, {.key = "columns", .value = "a"}));
  EXPECT_THAT(ReadError(kTable, {.columns = "-,theta_i,cheese,theta_o,f"}),
              IsError(ErrorKind::kUnknown, {.key = "columns", .value = "cheese"}));
  EXPECT_THAT(ReadError(kTable, {.columns = "theta_i=InAngle,theta_x=OutAngle,f=Value"}),
              IsError(ErrorKind::kUnknown, {.key = "columns", .value = "theta_x"}));
  EXPECT_EQ(Read(kTable, {.columns = ",theta_i,-,theta_o,f"}).samples.size(), 2);
}

TEST(NamedColumns, CountsMayStandBeforeTheRows) {
  const std::string rows = "30 10 0 0.25\n30 20 0 0.5\n";
  const SourceOptions options = {.columns = "theta_i,theta_o,phi_o,f"};
  for (const char* const counts : {"2\n", "1 2 1\n", "2 4\n1 2 1\n", "2 4 -1.000\n"}) {
    EXPECT_EQ(Read(counts + rows, options).samples.size(), 2) << counts;
  }
  EXPECT_THAT(Read("1 2 1\n" + rows, options).notes,
              ElementsAre(HasSubstr("1 line before the header")));
  // A row that breaks off is none.
  EXPECT_THAT(
      ReadError("30 10 0.5\n" + rows, options),
      IsError(ErrorKind::kFormat, {.file = "x.txt", .line = 1, .key = "columns", .value = "1"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
