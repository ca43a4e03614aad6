#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::optional<Error> ReadError(const std::string& text) {
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
              IsError(ErrorKind::kMismatch, {.key = "theta_o", .value = "1"}));
  EXPECT_THAT(ReadError(R"({"theta_i": [1, 2], "theta_o": [1, 2]})"),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "of values"}));
  EXPECT_THAT(
      ReadError(R"({"theta_i": [1, 2)"),
      IsError(ErrorKind::kFormat, {.file = "x.json", .line = 1, .key = "column", .value = "18"}));
  EXPECT_THAT(ReadError(R"({"data": {"theta_i": [1, 2]}})"),
              IsError(ErrorKind::kUnsupported, {.key = "content", .value = "a JSON file"}));
  EXPECT_THAT(ReadError(R"([{"theta_i": 1}])"),
              IsError(ErrorKind::kUnsupported, {.key = "content", .value = "a list in JSON"}));
  EXPECT_THAT(ReadError("[1, 2]"), IsError(ErrorKind::kMissing, {.key = "columns"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
