#ifndef TRILOBE_CORE_BASE_CHECK_H_
#define TRILOBE_CORE_BASE_CHECK_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "trilobe/core/base/error.h"

// Checks of arguments by public functions. Each throws Error with the argument's name if it fails.
// One that holds makes no string, as some are made for each value that a model is asked for.
namespace trilobe {

[[noreturn]] void FailNumber(std::string_view name, double value, std::string_view must_be);

// CheckNumber("stride", 0, stride >= 1, "1 or more"): "stride is 0; it must be 1 or more".
inline void CheckNumber(std::string_view name, double value, bool holds, std::string_view must_be) {
  if (!holds) FailNumber(name, value, must_be);
}

[[noreturn]] void FailIndex(int64_t index, int64_t size, const char* name);

// "the bin is 240; it must be from 0 to 239".
inline void CheckIndex(int64_t index, int64_t size, const char* name) {
  if (index < 0 || index >= size) FailIndex(index, size, name);
}

void CheckSize(std::string_view name, size_t size, size_t expected);

void CheckNumThreads(int num_threads);

template <typename T>
T& NotNull(T* pointer, const char* name) {
  if (pointer == nullptr) {
    throw Error(ErrorKind::kMissing, std::string(name) + " must not be null").About(name);
  }
  return *pointer;
}

template <typename F>
void CheckNotEmpty(const std::function<F>& function, const char* name) {
  if (!function) {
    throw Error(ErrorKind::kMissing, std::string(name) + " must be a function, not empty")
        .About(name);
  }
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_CHECK_H_
