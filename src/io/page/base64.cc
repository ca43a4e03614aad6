#include "io/page/base64.h"

#include <cstdint>

namespace trilobe {

std::string Base64(std::string_view bytes, int line) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + 4);
  int column = 0;
  for (size_t k = 0; k < bytes.size(); k += 3) {
    uint32_t three = 0;
    for (size_t b = 0; b < 3; ++b) {
      const char byte = k + b < bytes.size() ? bytes[k + b] : '\0';
      three = three << 8 | static_cast<unsigned char>(byte);
    }
    for (size_t d = 0; d < 4; ++d) {
      const bool padding = k + d > bytes.size();
      text += padding ? '=' : kDigits[three >> (6 * (3 - d)) & 63];
    }
    column += 4;
    if (line > 0 && column >= line && k + 3 < bytes.size()) {
      text += '\n';
      column = 0;
    }
  }
  return text;
}

}  // namespace trilobe
