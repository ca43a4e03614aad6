#ifndef TRILOBE_CORE_BASE_OPTION_VALUE_H_
#define TRILOBE_CORE_BASE_OPTION_VALUE_H_

#include <cstdint>
#include <string>
#include <variant>

namespace trilobe {

// Value of an option. Enumerators are given by name.
using OptionValue = std::variant<bool, int, uint64_t, double, std::string>;

// Valid numbers of an option.
struct OptionRange {
  const char* must_be = "";                // for errors: "0 or more"
  bool (*holds)(double number) = nullptr;  // null: all numbers are valid
};

// Throws Error with name and value if a number is out of range.
void CheckInRange(const std::string& name, const OptionValue& value, const OptionRange& range);

// For example "60", "0.001", "true", "active_set".
std::string ToText(const OptionValue& value);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_OPTION_VALUE_H_
