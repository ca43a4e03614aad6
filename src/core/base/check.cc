#include "trilobe/core/base/check.h"

#include <sstream>
#include <string>

namespace trilobe {

void FailNumber(std::string_view name, double value, std::string_view must_be) {
  constexpr int kDigits = 10;  // of any index
  std::ostringstream message;
  message.precision(kDigits);
  message << name << " is " << value << "; it must be " << must_be;
  throw Error(ErrorKind::kRange, message.str()).About(name, value);
}

void FailIndex(int64_t index, int64_t size, const char* name) {
  if (size <= 0) {
    throw Error(ErrorKind::kRange,
                std::string(name) + " is " + std::to_string(index) + ", but there is none")
        .About(name, index);
  }
  FailNumber(name, static_cast<double>(index), "from 0 to " + std::to_string(size - 1));
}

void CheckSize(std::string_view name, size_t size, size_t expected) {
  if (size == expected) return;
  throw Error(ErrorKind::kMismatch, std::string(name) + " has " + std::to_string(size) +
                                        " values; it must have " + std::to_string(expected))
      .About(name, size);
}

void CheckNumThreads(int num_threads) {
  CheckNumber("num_threads", num_threads, num_threads >= 1, "1 or more");
}

}  // namespace trilobe
