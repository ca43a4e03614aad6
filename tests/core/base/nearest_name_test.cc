#include "core/base/nearest_name.h"

#include <gtest/gtest.h>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(NearestName, TakesTheFewestEdits) {
  const std::vector<std::string_view> known = {"source", "name", "budget"};
  EXPECT_EQ(NearestName("sorce", known), "source");
  EXPECT_EQ(NearestName("budgets", known), "budget");
  EXPECT_EQ(NearestName("game", known), "name");
  EXPECT_EQ(NearestName("name", known), "name");
}

TEST(NearestName, CountsEdits) {
  EXPECT_EQ(EditDistance("lobs", "lobes"), 1U);
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3U);
  EXPECT_EQ(EditDistance("", "abc"), 3U);
}

TEST(NearestName, TakesTheFirstOfSeveral) {
  EXPECT_EQ(NearestName("", {"ab", "cd"}), "ab");
  EXPECT_EQ(NearestName("xx", {"ab", "cd"}), "ab");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
