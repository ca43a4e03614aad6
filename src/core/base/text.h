#ifndef TRILOBE_CORE_BASE_TEXT_H_
#define TRILOBE_CORE_BASE_TEXT_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace trilobe {

// A number to be read by people, of so many significant digits at most, in any locale with a point:
// "0.25", "1e-07", "infinite".
std::string Text(double x, int digits = 4);

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// Bytes of the UTF-8 sequence at the start of `text`; 0 if there is none (RFC 3629).
size_t Utf8Length(std::string_view text);

// A text as HTML and XML have it, between tags and in attributes.
std::string EscapedMarkup(std::string_view text);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_TEXT_H_
