#ifndef TRILOBE_IO_FORMATS_TEXT_FIRST_ROWS_H_
#define TRILOBE_IO_FORMATS_TEXT_FIRST_ROWS_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "io/formats/text/text_table.h"

namespace trilobe {

// Numbers of the first rows of a table, by which columns are told whose names leave something open.
class FirstRows {
 public:
  FirstRows() = default;
  explicit FirstRows(const TableHead& head);

  // Of each row; none for a cell without a number.
  std::vector<std::optional<double>> Column(size_t column) const;
  // Whether all cells of a column that hold something are numbers, and one does.
  bool IsOfNumbers(size_t column) const;

 private:
  size_t num_columns_ = 0;
  std::vector<std::vector<std::optional<double>>> rows_;
  std::vector<bool> has_text_;  // by column
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_FIRST_ROWS_H_
