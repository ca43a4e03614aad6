#include "trilobe/core/base/option_value.h"

#include <sstream>

#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

bool IsIn(const OptionRange& range, const OptionValue& value) {
  if (range.holds == nullptr) return true;
  if (const int* const number = std::get_if<int>(&value)) return range.holds(*number);
  return range.holds(std::get<double>(value));
}

}  // namespace

void CheckInRange(const std::string& name, const OptionValue& value, const OptionRange& range) {
  if (IsIn(range, value)) return;
  throw Error(ErrorKind::kRange, name + " is " + ToText(value) + "; it must be " + range.must_be)
      .About(name, ToText(value));
}

std::string ToText(const OptionValue& value) {
  std::ostringstream out;
  out << std::boolalpha;
  std::visit([&out](const auto& of_type) { out << of_type; }, value);
  return out.str();
}

}  // namespace trilobe
