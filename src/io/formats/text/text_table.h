#ifndef TRILOBE_IO_FORMATS_TEXT_TEXT_TABLE_H_
#define TRILOBE_IO_FORMATS_TEXT_TEXT_TABLE_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/text/given_angles.h"
#include "io/formats/text/table_columns.h"

namespace trilobe {

// Layout of a text table: the separator of its cells, and the place of its header.
struct TableHead {
  TextLines lines;  // at the header or, without one, before the first row
  std::vector<std::string> names = {};
  char separator = ',';     // or ';', '|', a tab, or ' ' for any number of blanks and tabs
  bool in_comment = false;  // the header stands behind # or %
  int lines_before = 0;     // lines of text before it, which are no comments
};

// Looks for the first line that names columns of angles and others, or for the last of comments
// before the first row. None if there is none. "theta" alone is an angle if `theta_is_given`.
std::optional<TableHead> FindTableHead(std::string_view text, const std::string& source,
                                       bool theta_is_given);

// The same for a table whose columns have these names, in the place of those of a header. A line of
// fewer whole numbers than are read stands before the rows. Throws Error if no line could be a row.
TableHead TableHeadBy(const std::vector<std::string>& names, std::string_view text,
                      const std::string& source);

// Positions of the columns of this name, "Angle" of "Angle [deg]", too, where none is called just
// that.
std::vector<size_t> PositionsOf(std::string_view name, const std::vector<std::string>& names);

// The head whose line has the most columns of these names. Throws Error if no line has one.
TableHead TableHeadWith(const std::vector<std::string>& wanted, std::string_view text,
                        const std::string& source);

// The separator of the first row after the head, which may be another than that of the header; goes
// beyond a line of units and adds these to the names.
void GoToRows(TableHead* head);

// Cells of a line as names of columns, for a table without known names.
std::vector<std::string> NamesOfFirstLine(std::string_view line);

// Whether lines of two numbers or more follow one another: a table, if not one of samples.
bool LooksLikeTwoColumns(std::string_view text);

// Whether a line could be a row: at least so many of its cells, and half of them, are numbers.
inline constexpr size_t kFewestNumbers = 3;
bool LooksLikeRow(std::string_view line, size_t fewest = kFewestNumbers);

// Whether the first line that is neither a comment nor, up to some, text could be a row.
bool IsTableOfNumbers(std::string_view text);

// Throws Error for a line of more cells than any table has, before they take memory.
void CheckLines(std::string_view text, const std::string& source);

// Cells of a row without quotes and white space at their ends.
void SplitRow(std::string_view line, char separator, std::vector<std::string_view>* cells);

// The first theta_i and phi_i that the lines before the first row of numbers give.
AnglesInText AnglesBeforeRows(std::string_view text);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_TEXT_TABLE_H_
