#include "trilobe/core/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <string_view>

#include "tests/error_of.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(Error, CarriesItsKindAndFacts) {
  const auto error = ErrorOf([] {
    throw Error(ErrorKind::kRange, "a.csv: line 3: lobes is 9").At("a.csv", 3).About("lobes", 9);
  });
  ASSERT_TRUE(error);
  EXPECT_STREQ(error->what(), "a.csv: line 3: lobes is 9");
  EXPECT_EQ(error->kind(), ErrorKind::kRange);
  EXPECT_EQ(error->facts().file, "a.csv");
  EXPECT_EQ(error->facts().line, 3);
  EXPECT_EQ(error->facts().key, "lobes");
  EXPECT_EQ(error->facts().value, "9");
  const ErrorFacts none = Error(ErrorKind::kData, "no light").facts();
  EXPECT_EQ(none.file + none.key + none.value, "");
  EXPECT_EQ(none.line, 0);
}

TEST(Error, KeepsThemInAnotherSentence) {
  const Error error = Error(ErrorKind::kFile, "cannot read").At("a\nb").About("read", "gone");
  const Error longer = error.WithMessage("the model: cannot read");
  EXPECT_STREQ(longer.what(), "the model: cannot read");
  EXPECT_EQ(longer.kind(), ErrorKind::kFile);
  EXPECT_EQ(longer.facts().file, "a\nb");  // as it was given
  EXPECT_EQ(longer.facts().value, "gone");
}

TEST(Error, SaysTheFileFirst) {
  const Error error = ErrorIn(ErrorKind::kData, "a.csv", "all are 0").About("--scale", 0.5);
  EXPECT_STREQ(error.what(), "a.csv: all are 0");
  EXPECT_EQ(error.facts().file, "a.csv");
  EXPECT_EQ(error.facts().key, "scale");
  EXPECT_EQ(error.facts().value, "0.5");
}

TEST(Error, FactsHaveNumbersAsText) {
  EXPECT_EQ(FactText(3), "3");
  EXPECT_EQ(FactText(-1e-300), "-1e-300");
  EXPECT_EQ(FactText(1234567890), "1234567890");
  EXPECT_EQ(FactText(-std::nan("")), "nan");
}

TEST(Error, EachKindHasAName) {
  std::set<std::string_view> names;
  for (int kind = 0; kind <= static_cast<int>(ErrorKind::kLimit); ++kind) {
    const std::string_view name = NameOf(static_cast<ErrorKind>(kind));
    EXPECT_NE(name, "");
    EXPECT_TRUE(names.insert(name).second) << name;
  }
  EXPECT_EQ(NameOf(ErrorKind::kUnsupported), "unsupported");
}

TEST(IsError, ComparesWhatIsGiven) {
  const auto error =
      ErrorOf([] { throw ErrorIn(ErrorKind::kRange, "a.csv", "lobes is 9").About("lobes", 9); });
  using testing::Not;
  EXPECT_THAT(error, IsError(ErrorKind::kRange));
  EXPECT_THAT(error, IsError(ErrorKind::kRange, {.file = "a.csv", .key = "lobes", .value = "9"}));
  EXPECT_THAT(error, Not(IsError(ErrorKind::kData)));
  EXPECT_THAT(error, Not(IsError(ErrorKind::kRange, {.file = "b.csv"})));
  EXPECT_THAT(error, Not(IsError(ErrorKind::kRange, {.line = 1})));
  EXPECT_THAT(error, Not(IsError(ErrorKind::kRange, {.key = "lobe"})));
  EXPECT_THAT(error, Not(IsError(ErrorKind::kRange, {.value = "8"})));
  EXPECT_EQ(testing::PrintToString(*error),
            "Error of kind range, file 'a.csv', line 0, key 'lobes', value '9': a.csv: lobes is 9");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
