#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/test_directory.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string ReadError(const std::string& text) {
  return ErrorOf([&] { Source("x.json", text).Read(); });
}

TEST(JsonTable, ColumnsAreReadAsThoseOfATextTable) {
  const Measurement is = Source("x.json",
                                R"({"sample": {"theta_i": 1}, "Theta_i [deg]": [30, 30.5, 30],
                                    "theta_o": [1e1, 20, 30], "phi_o": [0, 180, 0],
                                    "note": ["a", "b", "c"], "BRDF": [0.25, 0.5, null]})")
                             .Read();
  ASSERT_EQ(is.samples.size(), 2);  // null: not measured
  EXPECT_EQ(is.kind, "JSON file of scattered samples");
  EXPECT_NEAR(RadiansToDegrees(is.samples.directions[1].theta_i), 30.5, 1e-12);
  EXPECT_NEAR(RadiansToDegrees(is.samples.directions[0].theta_o), 10, 1e-12);
  EXPECT_EQ(is.samples.rho[1][2], 0.5);
  EXPECT_THAT(is.notes, ElementsAre(HasSubstr("left out: 'note'")));
}

TEST(JsonTable, OtherJsonIsTold) {
  EXPECT_THAT(ReadError(R"({"theta_i": [1, 2], "theta_o": [1], "f": [1, 2]})"),
              HasSubstr("'theta_o' lists 1 values, and 'theta_i' 2; columns are of one length"));
  EXPECT_THAT(ReadError(R"({"theta_i": [1, 2], "theta_o": [1, 2]})"),
              HasSubstr("the header has no column of values"));
  EXPECT_THAT(ReadError(R"({"theta_i": [1, 2)"), HasSubstr("x.json: line 1, column 18"));
  EXPECT_THAT(ReadError(R"({"data": {"theta_i": [1, 2]}})"),
              HasSubstr("this is a JSON file, with no columns theta_i, theta_o and brdf"));
  EXPECT_THAT(ReadError(R"([{"theta_i": 1}])"),
              HasSubstr("a list in JSON, which is not read; make it an object of columns"));
  EXPECT_THAT(ReadError("[1, 2]"), HasSubstr("without lists of columns in its outermost object"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
