#ifndef TRILOBE_IO_FORMATS_TEXT_TABLE_ROW_H_
#define TRILOBE_IO_FORMATS_TEXT_TABLE_ROW_H_

#include <string_view>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/text/column_layout.h"

namespace trilobe {

// The numbers of one row after the other of a text table.
class TableRow {
 public:
  // `layout` must stay.
  TableRow(char separator, const ColumnLayout& layout);

  // Takes the row of a line; false for a line of text. Throws Error for a row that lacks something.
  bool Take(const TextLines& lines) { return TakeNumbers(lines.line()) || TakeCells(lines); }
  // Throws Error for a line that is no row.
  [[noreturn]] void FailAsRow(const TextLines& lines) const;

  // Of the row taken. Throws Error for a cell without a number.
  double Number(const TextLines& lines, size_t column);
  bool IsGapAt(size_t column) const;
  std::string_view Cell(const TextLines& lines, size_t column);

  bool decimal_commas() const { return decimal_commas_; }  // in a row so far

 private:
  bool TakeNumbers(std::string_view line);
  bool TakeCells(const TextLines& lines);
  size_t TellingColumn() const;

  char separator_;
  const ColumnLayout* layout_;
  size_t num_read_ = 0;  // columns up to the last that is read
  std::vector<std::string_view> cells_;
  std::vector<double> numbers_;  // in the place of cells, where a row is but numbers
  bool is_numbers_ = false, decimal_commas_ = false;
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_TABLE_ROW_H_
