#include "core/base/text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace trilobe {

std::string Text(double x, int digits) {
  if (std::isinf(x)) return x > 0 ? "infinite" : "-infinite";
  std::array<char, 64> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), x,
                                 std::chars_format::general, digits);
  return {buffer.data(), end.ptr};
}

}  // namespace trilobe
