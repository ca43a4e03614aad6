#ifndef TRILOBE_IO_FORMATS_TEXT_SAME_NAME_H_
#define TRILOBE_IO_FORMATS_TEXT_SAME_NAME_H_

#include <algorithm>
#include <cctype>
#include <string_view>

namespace trilobe {

// Whether two names of a file are the same but for capitals.
inline bool SameName(std::string_view a, std::string_view b) {
  return std::ranges::equal(
      a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_SAME_NAME_H_
