#ifndef TRILOBE_IO_FORMATS_TEXT_TABLE_LINES_H_
#define TRILOBE_IO_FORMATS_TEXT_TABLE_LINES_H_

#include <optional>
#include <string>
#include <string_view>

namespace trilobe {

// The line without a comment (from # on); "#N/A" and the like of spreadsheets begin none.
std::string_view WithoutComment(std::string_view line);

// Whether a cell stands for a missing measurement: "", "NA", "#N/A".
bool IsGap(std::string_view cell);

// A number with a decimal comma; none for others.
std::optional<double> DecimalCommaNumber(std::string_view cell);

// A number as some programs write it: with a degree sign or "deg" behind it, or D before its
// exponent. None for what is no number.
std::optional<double> OddNumber(std::string_view cell);

// Reason why a cell holds no number, and advice.
std::string WhyNoNumber(std::string_view cell);

// Whether a line holds but separators, as a spreadsheet writes rows without cells.
bool IsEmptyRow(std::string_view line);

// Whether a line is but a rule of a table of characters: "|---|:--:|", "+----+----+".
bool IsRule(std::string_view line);

// Whether a line is text, and not a row that lacks something: its first word has no digit.
bool IsText(std::string_view line);

// The text with "-" for the minus sign of print (U+2212), and blanks for those of other widths.
std::string WithPlainSigns(std::string_view text);
// Whether there may be any; quick.
bool HasOddSigns(std::string_view text);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_TABLE_LINES_H_
