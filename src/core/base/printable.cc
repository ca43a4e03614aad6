#include "trilobe/core/base/printable.h"

#include <algorithm>
#include <cstddef>

#include "core/base/text.h"

namespace trilobe {
namespace {

bool IsControl(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  if (character.size() == 2) {  // C1 controls, U+0080 to U+009F
    return first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
  }
  // Marks, embeddings, overrides and isolates of bidirectional text; separators of lines and
  // paragraphs; the byte order mark.
  constexpr std::string_view kFormat[] = {"\u200E", "\u200F", "\u2028", "\u2029", "\u202A",
                                          "\u202B", "\u202C", "\u202D", "\u202E", "\u2066",
                                          "\u2067", "\u2068", "\u2069", "\uFEFF"};
  return std::ranges::find(kFormat, character) != std::end(kFormat);
}

void AppendEscaped(char c, std::string* escaped) {
  constexpr std::string_view kControls = "\n\r\t", kLetters = "nrt";
  if (const size_t k = kControls.find(c); k != std::string_view::npos) {
    *escaped += '\\';
    *escaped += kLetters[k];
  } else {
    AppendByte(c, escaped);
  }
}

}  // namespace

std::string Printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    const size_t length = Utf8Length(text);
    const std::string_view character = text.substr(0, std::max(length, size_t{1}));
    if (length == 0 || IsControl(character)) {
      for (const char c : character) AppendEscaped(c, &shown);
    } else {
      shown += character;
    }
    text.remove_prefix(character.size());
  }
  return shown;
}

}  // namespace trilobe
