#ifndef TRILOBE_IO_PICTURES_WORDS_H_
#define TRILOBE_IO_PICTURES_WORDS_H_

#include <span>
#include <string_view>

namespace trilobe {

// Captions of pictures that are written without gnuplot, which draws all other text.
enum class Word { kMeasured, kFitted, kModel, kFile };

// A word as rows of pixels of equal length, from the top, each with a code of its ink.
inline constexpr int kWordRows = 13;
inline constexpr std::string_view kInks = " .:+#";  // from none to all
std::span<const std::string_view> RowsOf(Word word);
double InkOf(char code);  // from 0 to 1

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_WORDS_H_
