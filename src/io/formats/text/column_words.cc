#include "io/formats/text/column_words.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>

#include "core/files/text_lines.h"

namespace trilobe {
namespace {

constexpr std::pair<std::string_view, std::string_view> kLetters[] = {
    {"入射角", "thetai"}, {"反射角", "thetao"}, {"受光角", "thetao"}, {"散射角", "thetao"},
    {"方位角", "phi"},    {"á", "a"},           {"é", "e"},           {"ó", "o"},
    {"à", "a"},           {"θ", "theta"},       {"ϑ", "theta"},       {"Θ", "theta"},
    {"φ", "phi"},         {"ϕ", "phi"},         {"Φ", "phi"},         {"ρ", "rho"},
    {"λ", "lambda"},      {"µ", "u"},           {"μ", "u"},           {"°", "deg"},
    {"º", "deg"},         {"ᵢ", "i"},           {"ₒ", "o"},           {"ᵣ", "r"},
    {"ₛ", "s"},           {"⁻¹", "^-1"},        {"\xB0", "deg"}};

}  // namespace

std::string Plain(std::string_view name) {
  std::string plain;
  while (!name.empty()) {
    const auto* const letter = std::ranges::find_if(
        kLetters, [&](const auto& entry) { return name.starts_with(entry.first); });
    if (letter != std::end(kLetters)) {
      plain += letter->second;
      name.remove_prefix(letter->first.size());
    } else {
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(name.front())));
      name.remove_prefix(1);
    }
  }
  return plain;
}

std::string TakeBracket(std::string* plain) {
  const std::string_view text = *plain;
  const size_t open = text.find_last_of("[("), close = text.find_last_of("])");
  if (open == 0 || open == std::string::npos || close == std::string::npos) return {};
  if (close < open) return {};
  std::string bracket(Trimmed(text.substr(open + 1, close - open - 1)));
  plain->resize(open);
  return bracket;
}

std::string LettersAndDigits(std::string_view plain) {
  std::string key;
  for (const char c : plain) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) key += c;
  }
  return key;
}

bool TakeSuffix(std::string_view suffix, std::string* key) {
  if (key->size() <= suffix.size() || !key->ends_with(suffix)) return false;
  key->resize(key->size() - suffix.size());
  return true;
}

bool IsOneOf(std::string_view word, std::span<const std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

}  // namespace trilobe
