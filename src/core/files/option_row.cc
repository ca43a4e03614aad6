#include "core/files/option_row.h"

#include <sstream>

#include "core/files/text_lines.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

void FailOptionText(std::string_view name, std::string_view text, const std::string& expected) {
  throw Error(ErrorKind::kFormat,
              "--" + std::string(name) + "=" + std::string(text) + ": give " + expected)
      .About(name, text);
}

double NumberOfOption(std::string_view name, std::string_view text) {
  if (const std::optional<double> number = ToNumber(text)) return *number;
  FailOptionText(name, text, "a number");
}

int IntegerOfOption(std::string_view name, std::string_view text) {
  if (const std::optional<int> number = ToInteger(text)) return *number;
  FailOptionText(name, text, "an integer");
}

bool TruthOfOption(std::string_view name, std::string_view text) {
  if (text == "true" || text == "false") return text == "true";
  FailOptionText(name, text, "true or false");
}

std::string OptionText(double number) {
  std::ostringstream text;
  text.precision(17);
  text << number;
  return text.str();
}

}  // namespace trilobe
