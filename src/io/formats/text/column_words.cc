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
    {"方位角", "phi"},    {"θ", "theta"},       {"ϑ", "theta"},       {"Θ", "theta"},
    {"φ", "phi"},         {"ϕ", "phi"},         {"Φ", "phi"},         {"ρ", "rho"},
    {"Δ", "delta"},       {"∆", "delta"},       {"π", "pi"},          {"λ", "lambda"},
    {"µ", "u"},           {"μ", "u"},           {"°", "deg"},         {"º", "deg"},
    {"ᵢ", "i"},           {"ₒ", "o"},           {"ᵣ", "r"},           {"ₛ", "s"},
    {"₁", "1"},           {"₂", "2"},           {"⁻¹", "^-1"},        {"’", "'"},
    {"\xB0", "deg"}};

// The letters 0xC0 to 0xFF of Latin-1 without their accents.
constexpr std::string_view kLatin1 =
    "aaaaaaaceeeeiiiidnooooo*ouuuuypsaaaaaaaceeeeiiiidnooooo/ouuuuypy";

bool IsContinuation(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

// Takes a letter with an accent, in UTF-8 or Latin-1, off the text; 0 if it begins with none.
char TakeAccented(std::string_view* text) {
  const auto first = static_cast<unsigned char>(text->front());
  const bool has_continuation = text->size() > 1 && IsContinuation((*text)[1]);
  if (first == 0xC3U && has_continuation) {
    const auto letter = static_cast<unsigned char>((*text)[1]) - 0x80U;
    text->remove_prefix(2);
    return kLatin1[letter];
  }
  if (first < 0xC0U || has_continuation) return 0;
  text->remove_prefix(1);
  return kLatin1[first - 0xC0U];
}

}  // namespace

std::string Plain(std::string_view name) {
  std::string plain;
  while (!name.empty()) {
    const auto* const letter = std::ranges::find_if(
        kLetters, [&](const auto& entry) { return name.starts_with(entry.first); });
    if (letter != std::end(kLetters)) {
      plain += letter->second;
      name.remove_prefix(letter->first.size());
    } else if (const char accented = TakeAccented(&name); accented != 0) {
      plain += accented;
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

std::vector<std::string> WordsOf(std::string_view name) {
  std::vector<std::string> words;
  char before = 0;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_letter = std::isalpha(byte) != 0 || byte >= 0x80U;
    const auto was = static_cast<unsigned char>(before);
    const bool goes_on = is_letter && (std::isalpha(was) != 0 || was >= 0x80U) &&
                         (std::isupper(byte) == 0 || std::isupper(was) != 0);
    if (is_letter && !goes_on) words.emplace_back();
    if (is_letter) words.back() += c;
    before = c;
  }
  for (std::string& word : words) word = LettersAndDigits(Plain(word));
  return words;
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
