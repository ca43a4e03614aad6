#include "core/files/utf16.h"

#include <cstddef>

namespace trilobe {

void AppendUtf8(uint32_t code, std::string* text) {
  const auto append = [text](uint32_t byte) { text->push_back(static_cast<char>(byte)); };
  const auto tail = [&](int shift) { append(0x80 | ((code >> shift) & 0x3F)); };
  if (code < 0x80) {
    append(code);
  } else if (code < 0x800) {
    append(0xC0 | (code >> 6));
    tail(0);
  } else if (code < 0x10000) {
    append(0xE0 | (code >> 12));
    tail(6);
    tail(0);
  } else {
    append(0xF0 | (code >> 18));
    tail(12);
    tail(6);
    tail(0);
  }
}

std::string Utf8OfUtf16(std::string_view bytes) {
  const bool little = bytes.starts_with("\xFF\xFE"), big = bytes.starts_with("\xFE\xFF");
  if ((!little && !big) || bytes.size() % 2 != 0) return {};
  const auto unit = [&](size_t k) -> uint32_t {
    const auto first = static_cast<unsigned char>(bytes[k]);
    const auto second = static_cast<unsigned char>(bytes[k + 1]);
    return little ? first | (second << 8U) : (first << 8U) | second;
  };
  std::string text;
  text.reserve(bytes.size() / 2);
  for (size_t k = 2; k < bytes.size(); k += 2) {
    uint32_t code = unit(k);
    if (code >= 0xD800 && code <= 0xDFFF) {
      if (code > 0xDBFF || k + 3 >= bytes.size()) return {};
      const uint32_t low = unit(k += 2);
      if (low < 0xDC00 || low > 0xDFFF) return {};
      code = 0x10000 + ((code - 0xD800) << 10U) + (low - 0xDC00);
    }
    AppendUtf8(code, &text);
  }
  return text;
}

}  // namespace trilobe
