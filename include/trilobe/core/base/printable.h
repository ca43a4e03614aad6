#ifndef TRILOBE_CORE_BASE_PRINTABLE_H_
#define TRILOBE_CORE_BASE_PRINTABLE_H_

#include <string>
#include <string_view>

namespace trilobe {

// Escapes arbitrary text, such as a file name, so that it is safe to print on one line:
// "a\nb\x1b[31m". Invalid UTF-8, line breaks, terminal control codes and bidirectional marks become
// their bytes. Printable characters are unchanged.
std::string Printable(std::string_view text);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_PRINTABLE_H_
