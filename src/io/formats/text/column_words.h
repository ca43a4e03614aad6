#ifndef TRILOBE_IO_FORMATS_TEXT_COLUMN_WORDS_H_
#define TRILOBE_IO_FORMATS_TEXT_COLUMN_WORDS_H_

#include <span>
#include <string>
#include <string_view>

namespace trilobe {

// A name in lower case, with Greek letters, and some words of other languages, as words.
std::string Plain(std::string_view name);

// Takes what stands in brackets off the end of a plain name: "deg" of "theta_i [deg]".
std::string TakeBracket(std::string* plain);

std::string LettersAndDigits(std::string_view plain);

// Takes the suffix off a key that is longer than it.
bool TakeSuffix(std::string_view suffix, std::string* key);

bool IsOneOf(std::string_view word, std::span<const std::string_view> words);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_COLUMN_WORDS_H_
