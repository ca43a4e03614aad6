#include "trilobe/core/base/printable.h"

#include <gtest/gtest.h>

#include <string>

#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(Printable, LeavesWhatIsPrintable) {
  for (const char* const text :
       {"", "a b", "out/copper.csv", "Käse, сыр, 芝士, 🧀", "C:\\x1b"}) {
    EXPECT_EQ(Printable(text), text);
  }
}

TEST(Printable, ShowsBytesOfAllElse) {
  EXPECT_EQ(Printable("a\nb\r\tc"), R"(a\nb\r\tc)");
  EXPECT_EQ(Printable(std::string("\0\x1b[31m\x7f", 7)), R"(\x00\x1b[31m\x7f)");
  EXPECT_EQ(Printable("\u009b31m\u0085\u2028"), R"(\xc2\x9b31m\xc2\x85\xe2\x80\xa8)");
  EXPECT_EQ(Printable("\u202egnp.exe"), R"(\xe2\x80\xaegnp.exe)");
  EXPECT_EQ(Printable("\xff\xc3"), R"(\xff\xc3)");  // not UTF-8
}

TEST(Printable, IsWhatEveryErrorIs) {
  EXPECT_STREQ(Error(ErrorKind::kFile, "cannot read 'a\nb'").what(), R"(cannot read 'a\nb')");
  EXPECT_EQ(MessageOf(std::runtime_error("a\nb")), R"(internal error: a\nb)");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
