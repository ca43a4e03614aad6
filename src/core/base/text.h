#ifndef TRILOBE_CORE_BASE_TEXT_H_
#define TRILOBE_CORE_BASE_TEXT_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace trilobe {

// Formats a number for people, with at most `digits` significant digits and a decimal point in any
// locale: "0.25", "1e-07", "infinite".
std::string Text(double x, int digits = 4);

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// Length in bytes of the UTF-8 sequence at the start of `text`; 0 if invalid (RFC 3629).
size_t Utf8Length(std::string_view text);

// Escapes text for HTML and XML, for use between tags and in attributes.
std::string EscapedMarkup(std::string_view text);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_TEXT_H_
