#ifndef TRILOBE_TESTS_ERROR_OF_H_
#define TRILOBE_TESTS_ERROR_OF_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "trilobe/core/base/error.h"

namespace trilobe {

// The Error that `call` throws; its message must be one line. None, and a failure, without.
template <typename Call>
std::optional<Error> ErrorOf(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos) << error.what();
    return error;
  }
  ADD_FAILURE() << "no Error was thrown";
  return std::nullopt;
}

// How tests print an Error.
inline void PrintTo(ErrorKind kind, std::ostream* out) { *out << NameOf(kind); }
inline void PrintTo(const Error& error, std::ostream* out) {
  const auto& [file, line, key, value] = error.facts();
  *out << "Error of kind " << NameOf(error.kind()) << ", file '" << file << "', line " << line
       << ", key '" << key << "', value '" << value << "': " << error.what();
}

// EXPECT_THAT(ErrorOf([] { ... }), IsError(ErrorKind::kRange, {.key = "lobes", .value = "9"})):
// facts that are not given are not compared.
inline testing::Matcher<std::optional<Error>> IsError(ErrorKind kind,
                                                      const ErrorFacts& facts = {}) {
  using testing::_;
  using testing::AllOf;
  using testing::Field;
  using testing::Matcher;
  using testing::Property;
  const auto text = [](const std::string& wanted) -> Matcher<std::string> {
    if (wanted.empty()) return _;
    return testing::StrEq(wanted);
  };
  const Matcher<int> line = facts.line == 0 ? Matcher<int>(_) : testing::Eq(facts.line);
  return testing::Optional(
      AllOf(Property("kind", &Error::kind, testing::Eq(kind)),
            Property("facts", &Error::facts,
                     AllOf(Field("file", &ErrorFacts::file, text(facts.file)),
                           Field("line", &ErrorFacts::line, line),
                           Field("key", &ErrorFacts::key, text(facts.key)),
                           Field("value", &ErrorFacts::value, text(facts.value))))));
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_ERROR_OF_H_
