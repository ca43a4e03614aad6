#ifndef TRILOBE_IO_PAGE_BASE64_H_
#define TRILOBE_IO_PAGE_BASE64_H_

#include <string>
#include <string_view>

namespace trilobe {

// RFC 4648, with padding; with a line break after each `line` characters, a multiple of 4, if that
// is not 0.
std::string Base64(std::string_view bytes, int line = 0);

}  // namespace trilobe

#endif  // TRILOBE_IO_PAGE_BASE64_H_
