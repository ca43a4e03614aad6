#ifndef TRILOBE_CORE_FILES_UTF16_H_
#define TRILOBE_CORE_FILES_UTF16_H_

#include <cstdint>
#include <string>
#include <string_view>

namespace trilobe {

// Appends a code point in UTF-8.
void AppendUtf8(uint32_t code, std::string* text);

// Text in UTF-16, which begins with a byte order mark, in UTF-8; "" for any other bytes, and where
// a surrogate stands alone. (Spreadsheets save "Unicode text" so.)
std::string Utf8OfUtf16(std::string_view bytes);

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_UTF16_H_
