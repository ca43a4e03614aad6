#ifndef TRILOBE_CORE_BASE_ERROR_H_
#define TRILOBE_CORE_BASE_ERROR_H_

#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

#include "trilobe/core/base/printable.h"

namespace trilobe {

// Bad input or an impossible request. what() is one printable line that a user can act on: what is
// wrong, where (file, bin, key), and what to do. The program prints it and exits with status 1.
// Programming errors are glog CHECKs instead.
class Error : public std::runtime_error {
 public:
  explicit Error(std::string_view message) : std::runtime_error(Printable(message)) {}
};

// One line about the exception that ended one of many jobs, while the other jobs continue.
inline std::string MessageOf(const std::exception& exception) {
  if (dynamic_cast<const Error*>(&exception) != nullptr) return exception.what();
  if (dynamic_cast<const std::bad_alloc*>(&exception) != nullptr) {
    return "out of memory; try fewer threads";
  }
  return "internal error: " + Printable(exception.what());
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_ERROR_H_
