#include "core/files/text_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(ToNumbers, AreThoseOfAllCellsOrNone) {
  EXPECT_THAT(ToNumbers("10, 30,1e1").value(), testing::ElementsAre(10, 30, 10));
  EXPECT_THAT(ToNumbers("").value(), testing::IsEmpty());
  for (const char* const line : {"10,x", "10,", ",", "10 30"})
    EXPECT_FALSE(ToNumbers(line)) << line;
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
