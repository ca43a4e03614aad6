#ifndef TRILOBE_CORE_BASE_PRINTABLE_H_
#define TRILOBE_CORE_BASE_PRINTABLE_H_

#include <string>
#include <string_view>

namespace trilobe {

// A text that may hold anything, as a name of a file may, on one line that means what it shows:
// "a\nb\x1b[31m". What is not UTF-8, breaks a line, steers a terminal or changes the direction of
// writing is shown by its bytes. What is printable already stays as it is.
std::string Printable(std::string_view text);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_PRINTABLE_H_
