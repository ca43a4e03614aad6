#ifndef TRILOBE_CORE_BASE_TEXT_H_
#define TRILOBE_CORE_BASE_TEXT_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace trilobe {

// Formats a number for people, with at most `digits` significant digits, but all of the integer
// part below 100,000 ("100", not "1e+02"), and a decimal point in any locale: "0.25", "1e-07",
// "infinite".
std::string Text(double x, int digits = 4);

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// Length in bytes of the UTF-8 sequence at the start of `text`; 0 if invalid (RFC 3629).
size_t Utf8Length(std::string_view text);

// Appends a byte as four characters, "\xe9".
void AppendByte(char byte, std::string* text);

// The same text, in which bytes that are no UTF-8 are four characters each, "\xe9" as Printable
// shows it. All text files are written so: a file's name may have any bytes.
std::string ValidUtf8(std::string_view text);

// Escapes text for HTML and XML, for use between tags and in attributes; it is valid UTF-8 then.
std::string EscapedMarkup(std::string_view text);

// A path as part of an address: what is not a letter, a digit or one of -._~/ as %XX (RFC 3986).
std::string EncodeAddress(std::string_view path);

// Text as a field of a CSV file: in UTF-8, and quoted where it must be (RFC 4180), or where another
// separator might be taken for that of fields. A spreadsheet would run what begins with one of
// = + - @, a tab or a carriage return as a formula: such text, or what begins with ', has a '
// before it, which readers of the file take off.
std::string CsvField(std::string_view text);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_TEXT_H_
