#ifndef TRILOBE_CORE_BASE_UTF8_H_
#define TRILOBE_CORE_BASE_UTF8_H_

#include <cstddef>
#include <string_view>

namespace trilobe {

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// Bytes of the UTF-8 sequence at the start of `text`; 0 if there is none (RFC 3629).
size_t Utf8Length(std::string_view text);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_UTF8_H_
