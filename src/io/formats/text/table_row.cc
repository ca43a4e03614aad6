#include "io/formats/text/table_row.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <system_error>

#include "io/formats/text/table_lines.h"
#include "io/formats/text/text_table.h"

namespace trilobe {

TableRow::TableRow(char separator, const ColumnLayout& layout)
    : separator_(separator), layout_(&layout) {
  const auto read = [&](size_t column) { num_read_ = std::max(num_read_, column + 1); };
  for (const std::optional<size_t>& angle : layout.angles) {
    if (angle) read(*angle);
  }
  for (const size_t column : layout.values) read(column);
  if (layout.wavelength) read(*layout.wavelength);
  if (layout.phase) read(*layout.phase);
}

bool TableRow::IsGapAt(size_t column) const { return !is_numbers_ && IsGap(cells_[column]); }

std::string_view TableRow::Cell(const TextLines& lines, size_t column) {
  if (is_numbers_) SplitRow(WithoutComment(lines.line()), separator_, &cells_);
  return cells_[column];
}

// Takes a row of numbers with a separator after each but the last, as nearly all rows are,
// without looking for its cells.
bool TableRow::TakeNumbers(std::string_view line) {
  const char* at = line.data();
  const char* const end = at + line.size();
  is_numbers_ = false;
  numbers_.resize(layout_->columns.size());
  for (size_t k = 0; k < numbers_.size(); ++k) {
    if (k > 0 && (at == end || *at++ != separator_)) return false;
    const auto [after, error] = std::from_chars(at, end, numbers_[k]);
    if (error != std::errc()) return false;
    at = after;
  }
  is_numbers_ = at == end;
  return is_numbers_;
}

// The same of any row; false for a line of text.
bool TableRow::TakeCells(const TextLines& lines) {
  const std::string_view line = WithoutComment(lines.line());
  if (line.empty() || IsRule(line) || IsEmptyRow(line)) return false;
  if (TakeNumbers(line)) return true;
  SplitRow(line, separator_, &cells_);
  const std::vector<TableColumn>& columns = layout_->columns;
  if (cells_.size() == columns.size() + 1 && cells_.back().empty()) cells_.pop_back();
  const bool has_all_read = cells_.size() <= columns.size() && cells_.size() >= num_read_;
  const auto is_number = [&](size_t column) {
    return ToNumber(cells_[column]) || DecimalCommaNumber(cells_[column]) ||
           OddNumber(cells_[column]);
  };
  if (IsText(line) && !(has_all_read && is_number(TellingColumn()))) return false;
  if (!has_all_read) FailAsRow(lines);
  cells_.resize(columns.size());
  return true;
}

// A column that holds a number in each row.
size_t TableRow::TellingColumn() const {
  const auto& [theta_i, phi_i, theta_o, phi_o] = layout_->angles;
  if (theta_o || theta_i) return theta_o ? *theta_o : *theta_i;
  return layout_->values.empty() ? 0 : layout_->values[0];
}

void TableRow::FailAsRow(const TextLines& lines) const {
  std::vector<std::string_view> cells;
  SplitRow(WithoutComment(lines.line()), separator_, &cells);
  const std::vector<TableColumn>& columns = layout_->columns;
  if (cells.size() == columns.size()) {
    const size_t telling = TellingColumn();
    ReadNumber(lines, telling, columns[telling].name, cells[telling]);  // throws
  }
  lines.Fail(std::to_string(cells.size()) + (cells.size() == 1 ? " column" : " columns") +
                 "; expected " + std::to_string(columns.size()) + ", from " + columns.front().name +
                 " to " + columns.back().name,
             ErrorKind::kFormat, "columns", std::to_string(cells.size()));
}

double TableRow::Number(const TextLines& lines, size_t column) {
  if (is_numbers_) return numbers_[column];
  if (const auto number = ToNumber(cells_[column])) return *number;
  if (const auto number = DecimalCommaNumber(cells_[column])) {
    decimal_commas_ = true;
    return *number;
  }
  if (const auto number = OddNumber(cells_[column])) return *number;
  lines.FailAt(column, layout_->columns[column].name, WhyNoNumber(cells_[column]),
               ErrorKind::kFormat, cells_[column]);
}

}  // namespace trilobe
