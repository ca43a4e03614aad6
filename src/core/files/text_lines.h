#ifndef TRILOBE_CORE_FILES_TEXT_LINES_H_
#define TRILOBE_CORE_FILES_TEXT_LINES_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

// Reads a text line by line and tracks the position for messages. Lines end with LF, CR LF or,
// where there is no LF, CR.
class TextLines {
 public:
  TextLines(std::string_view text, const std::string& source);

  // Goes to the next line that holds more than white space and a comment (from # on); false where
  // there is none.
  bool Next();
  std::string_view line() const { return line_; }  // without comment and white space at its ends

  std::string_view whole_line() const { return whole_line_; }  // with these

  // Goes to the next line that holds more than white space, and keeps its comment in line().
  bool NextWithComment();
  int number() const { return number_; }  // of the line, from 1

  // Throws Error: "SOURCE: line 12: PROBLEM", "SOURCE: line 12, column 3 (NAME): PROBLEM".
  // The key of the second is NAME. Columns are from 0.
  [[noreturn]] void Fail(const std::string& problem, ErrorKind kind = ErrorKind::kFormat,
                         std::string_view key = "", std::string_view value = "") const;
  [[noreturn]] void FailAt(size_t column, const std::string& name, const std::string& problem,
                           ErrorKind kind = ErrorKind::kFormat, std::string_view value = "") const;

 private:
  bool Next(bool with_comment);

  std::string_view rest_, line_, whole_line_;
  char end_ = '\n';
  std::string source_;
  int number_ = 0;
};

// The text without the white space at its ends.
std::string_view Trimmed(std::string_view text);

// Cells between separators, or words between white space; without white space at their ends.
std::vector<std::string_view> SplitCells(std::string_view line, char separator = ',');
std::vector<std::string_view> SplitWords(std::string_view line);

// A number that a cell holds, and nothing else; "nan" and "inf" are numbers.
std::optional<double> ToNumber(std::string_view cell);
std::optional<int> ToInteger(std::string_view cell);
// The numbers of cells between commas; none of an empty text, and nothing if a cell is no number.
std::optional<std::vector<double>> ToNumbers(std::string_view line);

// Whole numbers with an x between each two, as "30x30x60"; none where the text is anything else.
std::vector<int> IntegersByX(std::string_view text);

// The number of a cell of the line where `lines` is. Throws Error, with the column and its name.
double ReadNumber(const TextLines& lines, size_t column, const std::string& name,
                  std::string_view cell);

// The numbers of the line where `lines` is, one for each name. Throws Error where they are more or
// fewer, or no numbers.
void ReadNumbers(const TextLines& lines, const std::vector<std::string_view>& cells,
                 const std::vector<std::string>& names, std::vector<double>* numbers);

// `number` times `unit` [rad], likewise. Throws Error unless it is from `min_deg` to `max_deg`, to
// the rounding of angles in files.
struct AngleRange {
  double min_deg, max_deg;
};
double ReadAngle(const TextLines& lines, size_t column, const std::string& name, double number,
                 double unit, const AngleRange& range);
inline constexpr double kAngleRounding = 1e-4;  // [rad]

// Directions out of such numbers, in units of `unit` [rad]; `columns` says which are theta_i,
// phi_i, theta_o and phi_o. Throws Error unless theta is from 0 to 180 degrees (beyond 90 it is
// below the surface) and phi from -360 to 360.
struct AngleColumns {
  size_t theta_i = 0, phi_i = 1, theta_o = 2, phi_o = 3;
};
SphericalAngles ReadAngles(const TextLines& lines, const std::vector<std::string>& names,
                           const std::vector<double>& numbers, const AngleColumns& columns,
                           double unit);

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_TEXT_LINES_H_
