// Cells without numbers, and signs and blanks of print.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "io/formats/text/table_lines.h"
#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

Measurement Read(const std::string& text, const SourceOptions& options = {}) {
  return Source("x.csv", text).Read(options);
}

std::optional<Error> ReadError(const std::string& text, const SourceOptions& options = {}) {
  return ErrorOf([&] { Read(text, options); });
}

const std::string kHead = "theta_i,theta_o,phi_o,f\n";

TEST(OddCells, RowsWithoutCellsAreSkipped) {
  const Measurement read = Read(kHead + "30,10,0,1\n,,,\n30,20,0,2\n,,,,,\n;;\n");
  EXPECT_EQ(read.samples.size(), 2);
  EXPECT_EQ(read.counts.missing, 0);
  EXPECT_EQ(Read("theta_i;theta_o;f;;\n30;10;0,5;;\n;;;;\n").samples.rho[0][0], 0.5);
  EXPECT_THAT(ReadError(kHead + "30,10,0,1\n30,,0,2\n"),
              IsError(ErrorKind::kMissing, {.line = 3, .key = "theta_o"}));
}

TEST(OddCells, MarksOfGapsAreGaps) {
  for (const char* const mark : {"None", "ND", "n.d.", ".", "*", "*****", "", "NA", "#N/A"}) {
    const Measurement read = Read(kHead + "30,10,0,1\n30,20,0," + mark + "\n");
    EXPECT_EQ(read.samples.size(), 1) << mark;
    EXPECT_EQ(read.counts.missing, 1) << mark;
  }
  EXPECT_THAT(ReadError(kHead + "30,10,0,1\n30,20,0,nothing\n"),
              IsError(ErrorKind::kFormat, {.line = 3, .key = "f", .value = "nothing"}));
  // Lines of text may begin with such words.
  EXPECT_EQ(Read(kHead + "30,10,0,1\n* a footnote\nNone of these\n").samples.size(), 1);
}

TEST(OddCells, MinusSignsAndBlanksOfPrintAreRead) {
  const Measurement read = Read("theta_i;theta_o;f\n30\u00A0;\u221220;\u20090,5\n30\xA0;20;1\n");
  ASSERT_EQ(read.samples.size(), 2);
  EXPECT_EQ(read.samples.rho[0][0], 0.5);
  EXPECT_NEAR(read.samples.directions[0].theta_o, DegreesToRadians(20), 1e-12);
  EXPECT_EQ(WithPlainSigns("\u00E0 b"), "\u00E0 b");  // ends with the same byte
}

TEST(OddCells, TheNormalNeedsNoAzimuth) {
  for (const char* const cell : {"NaN", "", "-999", "NA"}) {
    const Measurement read = Read(kHead + "30,0," + cell + ",1\n30,10,90,2\n");
    ASSERT_EQ(read.samples.size(), 2) << cell;
    EXPECT_EQ(read.samples.directions[0].phi_o, 0) << cell;
    EXPECT_THAT(ReadError(kHead + "30,10," + cell + ",1\n"), testing::Optional(testing::_)) << cell;
  }
}

TEST(OddCells, AnEmptyThetaIsToBeFilledDown) {
  const std::optional<Error> error = ReadError(kHead + "30,10,0,1\n,20,0,2\n");
  EXPECT_THAT(error, IsError(ErrorKind::kMissing, {.line = 3, .key = "theta_i"}));
  EXPECT_THAT(error->what(), HasSubstr("fill the cells down"));
}

TEST(OddCells, TheSeparatorGivesNumbersInEachCell) {
  const Measurement read =
      Read("Angle d'incidence : 10\u00B0\n-20;0,25\n20;0,5\n", {.columns = "theta_o,f"});
  ASSERT_EQ(read.samples.size(), 2);
  EXPECT_EQ(read.samples.rho[1][0], 0.5);
  EXPECT_EQ(Read("-20,0.25\n20,0.5\n", {.columns = "theta_o,f", .theta_i_deg = 10}).samples.size(),
            2);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
