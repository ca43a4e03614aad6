#include "core/base/text.h"

#include <gtest/gtest.h>

#include <limits>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(Text, HasSoManyDigitsAtMost) {
  EXPECT_EQ(Text(0.0123456), "0.01235");
  EXPECT_EQ(Text(1234567.0), "1.235e+06");
  EXPECT_EQ(Text(99.96, 2), "100");
  EXPECT_EQ(Text(-5512.4, 2), "-5512");
  EXPECT_EQ(Text(0.25, 6), "0.25");
  EXPECT_EQ(Text(1e-7, 6), "1e-07");
  EXPECT_EQ(Text(-std::numeric_limits<double>::infinity()), "-infinite");
}

TEST(ValidUtf8, ShowsOtherBytes) {
  EXPECT_EQ(ValidUtf8("caf\xe9.csv"), "caf\\xe9.csv");
  EXPECT_EQ(ValidUtf8("\xff_\xc3"), "\\xff_\\xc3");
  EXPECT_EQ(ValidUtf8("caf\xc3\xa9\n"), "caf\xc3\xa9\n");
  EXPECT_EQ(EscapedMarkup("\xe9<"), "\\xe9&lt;");
}

// A name may not run in a spreadsheet.
TEST(CsvField, IsNoFormula) {
  EXPECT_EQ(CsvField("copper"), "copper");
  EXPECT_EQ(CsvField("a,b"), "\"a,b\"");
  EXPECT_EQ(CsvField("a;=b"), "\"a;=b\"");
  EXPECT_EQ(CsvField("say \"x\""), "\"say \"\"x\"\"\"");
  for (const std::string name : {"=1+1", "+1", "-1", "@a", "\tx", "\rx", "'=1"}) {
    EXPECT_EQ(CsvField(name), "\"'" + name + "\"");
  }
  EXPECT_EQ(CsvField("a=b"), "a=b");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
