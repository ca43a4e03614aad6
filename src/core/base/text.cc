#include "core/base/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace trilobe {

std::string Text(double x, int digits) {
  constexpr double kWithoutExponent = 1e5;
  if (std::isinf(x)) return x > 0 ? "infinite" : "-infinite";
  std::array<char, 64> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), x,
                                 std::chars_format::general, digits);
  std::string text{buffer.data(), end.ptr};
  // "100 %" is read as it is, "1e+02 %" is not.
  const bool has_exponent = text.find("e+") != std::string::npos;
  if (has_exponent && std::abs(x) < kWithoutExponent) return std::to_string(std::llround(x));
  return text;
}

size_t Utf8Length(std::string_view text) {
  if (text.empty()) return 0;
  const auto byte = [&](size_t k) -> unsigned {
    return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U;
  };
  const auto follows = [&](size_t k, unsigned low, unsigned high) {
    return byte(k) >= low && byte(k) <= high;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1, 0x80, 0xBF) ? 2 : 0;
  // The second byte excludes overlong forms, surrogates, and what is above U+10FFFF.
  const unsigned low = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
  const unsigned high = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
  if (!follows(1, low, high) || !follows(2, 0x80, 0xBF)) return 0;
  if (first >= 0xE0 && first <= 0xEF) return 3;
  return first >= 0xF0 && first <= 0xF4 && follows(3, 0x80, 0xBF) ? 4 : 0;
}

void AppendByte(char byte, std::string* text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  const auto value = static_cast<unsigned char>(byte);
  *text += "\\x";
  *text += kDigits[value >> 4];
  *text += kDigits[value & 15];
}

std::string ValidUtf8(std::string_view text) {
  std::string valid;
  valid.reserve(text.size());
  while (!text.empty()) {
    const size_t length = Utf8Length(text);
    if (length > 0) {
      valid += text.substr(0, length);
    } else {
      AppendByte(text[0], &valid);
    }
    text.remove_prefix(std::max(length, size_t{1}));
  }
  return valid;
}

std::string EscapedMarkup(std::string_view text) {
  std::string escaped;
  for (const char c : ValidUtf8(text)) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string EncodeAddress(std::string_view path) {
  std::string address;
  for (const char c : path) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("-._~/").find(c) != std::string_view::npos;
    if (plain) {
      address += c;
    } else {
      constexpr char kDigits[] = "0123456789ABCDEF";
      const auto byte = static_cast<unsigned char>(c);
      address += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return address;
}

std::string CsvField(std::string_view any_text) {
  constexpr std::string_view kFormula = "=+-@\t\r", kSeparators = ",;\t\"\r\n";
  std::string text = ValidUtf8(any_text);
  const bool guarded = !text.empty() && (text.front() == '\'' ||
                                         kFormula.find(text.front()) != std::string_view::npos);
  if (guarded) text.insert(0, "'");
  if (!guarded && text.find_first_of(kSeparators) == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace trilobe
