#include "io/pictures/words.h"

#include <gtest/gtest.h>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(WordsTest, AreRectanglesOfKnownInks) {
  for (const Word word : {Word::kMeasured, Word::kFitted, Word::kModel, Word::kFile}) {
    const auto rows = RowsOf(word);
    ASSERT_EQ(rows.size(), static_cast<size_t>(kWordRows));
    for (const std::string_view row : rows) {
      EXPECT_EQ(row.size(), rows.front().size());
      EXPECT_EQ(row.find_first_not_of(kInks), std::string_view::npos);
    }
  }
  EXPECT_EQ(InkOf(' '), 0);
  EXPECT_EQ(InkOf('#'), 1);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
