#ifndef TRILOBE_IO_FORMATS_TEXT_ROW_CHOICE_H_
#define TRILOBE_IO_FORMATS_TEXT_ROW_CHOICE_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/text/table_row.h"

namespace trilobe {

// The rows of a text table that are read, by cells of its columns: "polarization=s,sample=2".
class RowChoice {
 public:
  // rows: SourceOptions::rows, "" for all. Throws Error, with the line of `header`, unless each
  // part is one of the columns and a cell.
  RowChoice(const std::string& rows, const std::vector<std::string>& columns,
            const TextLines& header);

  std::vector<size_t> columns() const;  // by which rows are chosen
  // Whether the row has the cells.
  bool Takes(const TextLines& lines, TableRow* row);
  // Throws Error if rows were asked about, and none was taken.
  void CheckTaken() const;

 private:
  struct Part {
    size_t column;
    std::string cell;
    std::vector<std::string> others = {};  // some of the cells that were there in its place
  };
  std::string rows_;
  std::vector<Part> parts_;
  TextLines header_;
  bool asked_ = false, taken_ = false;
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_ROW_CHOICE_H_
