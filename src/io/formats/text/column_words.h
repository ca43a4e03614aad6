#ifndef TRILOBE_IO_FORMATS_TEXT_COLUMN_WORDS_H_
#define TRILOBE_IO_FORMATS_TEXT_COLUMN_WORDS_H_

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trilobe {

// A name in lower case, with Greek letters, and some words of other languages, as words, and
// without accents, in UTF-8 or Latin-1.
std::string Plain(std::string_view name);

// Takes what stands in brackets off the end of a plain name: "deg" of "theta_i [deg]".
std::string TakeBracket(std::string* plain);

// The words of a name that has blanks, signs, digits or capitals between them: "rel" and "az" of
// "relAz", in lower case and without digits.
std::vector<std::string> WordsOf(std::string_view name);

std::string LettersAndDigits(std::string_view plain);

// Takes the suffix off a key that is longer than it.
bool TakeSuffix(std::string_view suffix, std::string* key);

bool IsOneOf(std::string_view word, std::span<const std::string_view> words);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_COLUMN_WORDS_H_
