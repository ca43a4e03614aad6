// Angles that lines of text give to the rows below them.
#include "io/formats/text/given_angles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

Measurement Read(const std::string& text, const SourceOptions& options = {}) {
  return Source("x.txt", text).Read(options);
}

std::optional<Error> ReadError(const std::string& text, const SourceOptions& options = {}) {
  return ErrorOf([&] { Read(text, options); });
}

TEST(GivenAngles, ALineMayGiveSeveral) {
  for (const char* const line :
       {"# theta_i = 30, phi_i = 270", "theta_in=30 phi_in=270", "theta_i: 30 deg; phi_i: 270 deg",
        "# incident angle theta_in=30 phi_in=270", "Incidence angle: 30 deg, azimuth: 270 deg",
        "# lambda = 550 nm, theta_i=30deg, phi_i=-90", "source elevation: 60; phi_i = 270"}) {
    const AnglesInText angles = AnglesInLine(line);
    ASSERT_TRUE(angles.theta_i) << line;
    EXPECT_NEAR(RadiansToDegrees(*angles.theta_i), 30, 1e-9) << line;
    if (std::string(line).find("-90") != std::string::npos) continue;
    ASSERT_TRUE(angles.phi_i) << line;
    EXPECT_NEAR(RadiansToDegrees(*angles.phi_i), 270, 1e-9) << line;
  }
  for (const char* const line :
       {"theta_i = 20 to 60", "azimuth: 90", "theta_i,20,40,60", "sample 3, theta_i: 30",
        "theta_i = 30 and more", "Date: 2021-03-04", "theta_o = 30"}) {
    EXPECT_FALSE(AnglesInLine(line)) << line;
  }
}

const std::string kHead = "theta_o,phi_o,brdf\n", kRows = "10,0,0.25\n20,180,0.5\n";

TEST(GivenAngles, PhiIIsUsedAndNoted) {
  for (const std::string given : {"# theta_i = 45, phi_i = 90\n", "# theta_i = 45\n# phi_i = 90\n",
                                  "Incidence angle: 45 deg\nIncidence azimuth: 90 deg\n"}) {
    const Measurement read = Read(given + kHead + kRows);
    ASSERT_EQ(read.samples.size(), 2) << given;
    EXPECT_NEAR(RadiansToDegrees(read.samples.directions[0].phi_i), 90, 1e-9);
    EXPECT_EQ(read.samples.directions[0].phi_o, 0);
    EXPECT_THAT(read.notes, ElementsAre(HasSubstr("phi_i = 90 deg"))) << given;
  }
  // A difference counts from it, and all lies in its plane where no column has azimuths.
  const Measurement by_difference = Read("# theta_i = 45, phi_i = 90\ntheta_o,dphi,brdf\n" + kRows);
  EXPECT_NEAR(RadiansToDegrees(by_difference.samples.directions[0].phi_o), 90, 1e-9);
  const Measurement in_plane = Read("# theta_i = 45, phi_i = 90\ntheta_o,brdf\n10,1\n20,2\n");
  EXPECT_NEAR(RadiansToDegrees(in_plane.samples.directions[0].phi_o), 270, 1e-9);
}

TEST(GivenAngles, BlocksMayBeginInComments) {
  const Measurement read = Read(
      "# theta_i = 20, phi_i = 0\n# theta_o phi_o brdf\n10 0 1\n\n\n"
      "# theta_i = 40, phi_i = 90\n# theta_o phi_o brdf\n10 0 2\n[Scan 3]\n"
      "theta_i = 60\n10 0 3\n");
  ASSERT_EQ(read.samples.size(), 3);
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR(RadiansToDegrees(read.samples.directions[j].theta_i), 20 * (j + 1), 1e-9);
  }
  EXPECT_NEAR(RadiansToDegrees(read.samples.directions[1].phi_i), 90, 1e-9);
  EXPECT_THAT(read.notes, Contains(HasSubstr("phi_i by lines between the rows")));
}

TEST(GivenAngles, AFlagMayContradictThem) {
  const std::string one = "theta_i = 20\n" + kHead + kRows;
  const Measurement read = Read(one, {.theta_i_deg = 30});
  EXPECT_NEAR(RadiansToDegrees(read.samples.directions[0].theta_i), 30, 1e-9);
  EXPECT_THAT(read.notes, Contains(HasSubstr("that of --theta_i, and not 20 deg")));
  EXPECT_THAT(Read(one, {.theta_i_deg = 20}).notes, ElementsAre(HasSubstr("read as")));
  EXPECT_THAT(ReadError(one + "theta_i = 40\n" + kRows, {.theta_i_deg = 20}),
              IsError(ErrorKind::kConflict, {.line = 5, .key = "theta_i", .value = "40"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
