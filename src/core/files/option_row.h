#ifndef TRILOBE_CORE_FILES_OPTION_ROW_H_
#define TRILOBE_CORE_FILES_OPTION_ROW_H_

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "trilobe/core/base/option_value.h"

// Rows of tables of options: SourceOption and FitOption. A row has the members
//   std::string name, help;
//   OptionValue default_value;  // of the flag
//   OptionRange range;          // of a number
//   void (*set)(std::string_view text, Options* options);
//   std::string (*get)(const Options& options);  // differs for different values
namespace trilobe {

// Throws Error: "--tilt=x: give EXPECTED".
[[noreturn]] void FailOptionText(std::string_view name, std::string_view text,
                                 const std::string& expected);

// The value of an option by the text of its flag. These throw Error, with flag and text, for a text
// that means nothing.
double NumberOfOption(std::string_view name, std::string_view text);
int IntegerOfOption(std::string_view name, std::string_view text);
bool TruthOfOption(std::string_view name, std::string_view text);

// A text that differs for different numbers, and reads as the same number.
std::string OptionText(double number);

// Throws Error for a number that is out of the range of its row.
template <typename Row, typename Options>
void CheckRange(const Row& row, const Options& options) {
  if (row.range.holds == nullptr) return;
  const std::string text = row.get(options);
  if (text.empty()) return;  // not given
  CheckInRange("--" + row.name, NumberOfOption(row.name, text), row.range);
}

// A name that template arguments can hold.
template <size_t kSize>
struct OptionName {
  char text[kSize];
  constexpr OptionName(const char (&name)[kSize]) {  // NOLINT(google-explicit-constructor): literal
    for (size_t k = 0; k < kSize; ++k) text[k] = name[k];
  }
};

template <typename T>
struct MemberTraits;
template <typename Options, typename T>
struct MemberTraits<T Options::*> {
  using Class = Options;
  using Type = T;
};

// The row of the option that is this member: a truth, a number or a text. An optional member is
// without a value where the option was not given; the default value of its flag stands in `row`.
template <typename Row, OptionName kName, auto kMember>
Row MemberRow(Row row) {
  using Options = typename MemberTraits<decltype(kMember)>::Class;
  using T = typename MemberTraits<decltype(kMember)>::Type;
  constexpr bool kOptional =
      std::is_same_v<T, std::optional<double>> || std::is_same_v<T, std::optional<int>>;
  row.name = kName.text;
  if constexpr (!kOptional) row.default_value = Options().*kMember;
  row.set = [](std::string_view text, Options* options) {
    if constexpr (std::is_same_v<T, std::string>) {
      options->*kMember = std::string(text);
    } else if constexpr (std::is_same_v<T, bool>) {
      options->*kMember = TruthOfOption(kName.text, text);
    } else if constexpr (std::is_same_v<T, std::optional<int>>) {
      options->*kMember = IntegerOfOption(kName.text, text);
    } else {
      options->*kMember = NumberOfOption(kName.text, text);
    }
  };
  row.get = [](const Options& options) -> std::string {
    const T& value = options.*kMember;
    if constexpr (std::is_same_v<T, std::string>) {
      return value;
    } else if constexpr (kOptional) {
      return value ? OptionText(*value) : "";
    } else {
      return OptionText(value);
    }
  };
  return row;
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_OPTION_ROW_H_
