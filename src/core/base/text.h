#ifndef TRILOBE_CORE_BASE_TEXT_H_
#define TRILOBE_CORE_BASE_TEXT_H_

#include <string>

namespace trilobe {

// A number to be read by people, of so many significant digits at most, in any locale with a point:
// "0.25", "1e-07", "infinite".
std::string Text(double x, int digits = 4);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_TEXT_H_
