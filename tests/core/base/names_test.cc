#include "core/base/names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

struct Choice {
  std::string name;
  int value = 0;
};

const std::vector<Choice> kChoices = {{"first", 1}, {"second", 2}};

std::optional<Error> ErrorFor(std::string_view name, const std::vector<Choice>& choices) {
  return ErrorOf([&] { FindNamed("choice", name, choices); });
}

TEST(FindNamed, FindsByTheWholeName) {
  EXPECT_EQ(FindNamed("choice", "first", kChoices).value, 1);
  EXPECT_EQ(&FindNamed("choice", "second", kChoices), &kChoices[1]);
}

TEST(FindNamed, ListsTheKnownNamesOtherwise) {
  EXPECT_THAT(ErrorFor("third", kChoices),
              IsError(ErrorKind::kUnknown, {.key = "choice", .value = "third"}));
  EXPECT_THAT(ErrorFor("", kChoices), IsError(ErrorKind::kUnknown, {.key = "choice"}));
  EXPECT_THAT(ErrorFor("firs", kChoices),
              IsError(ErrorKind::kUnknown, {.key = "choice", .value = "firs"}));
  EXPECT_THAT(ErrorFor("First", kChoices),
              IsError(ErrorKind::kUnknown, {.key = "choice", .value = "First"}));
}

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
  EXPECT_EQ(EditDistance("alws", "awls"), 1U);
}

TEST(NearestName, TakesTheFirstOfSeveral) {
  EXPECT_EQ(NearestName("", {"ab", "cd"}), "ab");
  EXPECT_EQ(NearestName("xx", {"ab", "cd"}), "ab");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
