// Azimuths under any name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "io/formats/text/table_columns.h"
#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;
using testing::Not;

ColumnRole RoleOf(const std::string& name) { return ColumnNamed(name).role; }

TEST(AzimuthNames, ADifferenceIsThatOfTwo) {
  for (const char* const name :
       {"relAz", "rel_azimuth", "relative azimuth angle", "phi_rel", "dazi", "daa", "RAA",
        "azimuth_difference", "Azimutdifferenz", "differenza di azimut", "delta phi",
        "view-sun azimuth difference", "azimut relatif", "\u0394\u03C6"}) {
    const TableColumn column = ColumnNamed(name);
    EXPECT_EQ(column.role, ColumnRole::kPhi) << name;
    EXPECT_TRUE(column.is_difference) << name;
  }
  for (const char* const name : {"azi", "azimut", "Azimutwinkel", "phi (deg)"}) {
    EXPECT_EQ(RoleOf(name), ColumnRole::kPhi) << name;
    EXPECT_FALSE(ColumnNamed(name).is_difference) << name;
  }
}

TEST(AzimuthNames, WordsOfADirectionCount) {
  for (const char* const name : {"sun azimuth", "saa", "az_i", "Quelle_Azimut", "azimuth in"}) {
    EXPECT_EQ(RoleOf(name), ColumnRole::kPhiI) << name;
  }
  for (const char* const name : {"view_azi", "vaa", "Detektor Azimut", "azimuth of detector"}) {
    EXPECT_EQ(RoleOf(name), ColumnRole::kPhiO) << name;
  }
  // Of half vectors, of errors, and words that only hold such letters.
  for (const char* const name : {"phi_h", "phi_d", "azimuth error", "haze", "glazing"}) {
    EXPECT_EQ(RoleOf(name), ColumnRole::kOther) << name;
  }
}

const std::string kRows = "30,10,90,0.25\n30,20,180,0.5\n";

Measurement Read(const std::string& text, const SourceOptions& options = {}) {
  return Source("x.csv", text).Read(options);
}

std::string Problem(const std::string& text, const SourceOptions& options = {}) {
  const std::optional<Error> error = ErrorOf([&] { Read(text, options); });
  return error ? error->what() : "";
}

TEST(AzimuthNames, OneThatIsNotUnderstoodIsAsked) {
  const std::string text = "theta_i,theta_o,stage azimuth,f\n" + kRows;
  EXPECT_THAT(Problem(text), HasSubstr("type '--columns=phi_o=stage azimuth' if"));
  EXPECT_NEAR(Read(text, {.columns = "phi_o=stage azimuth"}).samples.directions[0].phi_o, kPi / 2,
              1e-12);
  EXPECT_THAT(Read(text, {.columns = "-=stage azimuth"}).notes[0],
              HasSubstr("left out: 'stage azimuth'"));
  // Beside one that is understood it is left out, as what is no azimuth.
  EXPECT_EQ(Read("theta_i,theta_o,phi_o,stage azimuth,f\n30,10,90,0,0.25\n").samples.size(), 1);
  EXPECT_EQ(Read("theta_i,theta_o,haze,f\n" + kRows).samples.size(), 2);
}

TEST(AzimuthNames, NoAdviceLeavesOneOut) {
  for (const char* const name : {"relAz", "dazi", "phi_rel", "azimut", "differenza di azimut"}) {
    EXPECT_THAT(Problem(std::string("sza,vza,") + name + ",BRF\n" + kRows),
                HasSubstr("--columns=theta_i,theta_o,phi_o,f --scale=0.3183"))
        << name;
  }
  EXPECT_THAT(Problem("sza,vza,odd azimuth,BRF\n" + kRows), Not(HasSubstr(",-,")));
  // Units, elevations and angles from the mirror direction stay what they are.
  EXPECT_THAT(Problem("theta_i_rad,from_mirror,phi (gon),BRF\n1,1,1,1\n"),
              HasSubstr("--columns=theta_i_rad,from_mirror,phi_o_gon,f "));
  EXPECT_THAT(Problem("sun elevation,view elevation,phi,phi_o,BRF\n1,1,1,1,1\n"),
              HasSubstr("--columns=elevation_i,elevation_o,-,phi_o,f "));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
