#include "io/formats/text/first_rows.h"

#include <algorithm>
#include <string_view>

#include "core/files/text_lines.h"
#include "io/formats/text/table_lines.h"

namespace trilobe {

FirstRows::FirstRows(const TableHead& head)
    : num_columns_(head.names.size()), has_text_(num_columns_) {
  constexpr size_t kMostRows = 2000;
  std::vector<std::string_view> cells;
  for (TextLines lines = head.lines; rows_.size() < kMostRows && lines.NextWithComment();) {
    const std::string_view line = WithoutComment(lines.line());
    SplitRow(line, head.separator, &cells);
    if (cells.size() == num_columns_ + 1 && cells.back().empty()) cells.pop_back();
    if (cells.size() != num_columns_) continue;
    std::vector<std::optional<double>> row;
    for (const std::string_view cell : cells) {
      const std::optional<double> number = ToNumber(cell);
      row.push_back(number ? number : DecimalCommaNumber(cell));
    }
    if (std::ranges::none_of(row, [](const auto& cell) { return cell.has_value(); })) continue;
    for (size_t k = 0; k < num_columns_; ++k) {
      if (!row[k] && !IsGap(cells[k])) has_text_[k] = true;
    }
    rows_.push_back(std::move(row));
  }
}

std::vector<std::optional<double>> FirstRows::Column(size_t column) const {
  std::vector<std::optional<double>> cells;
  if (column >= num_columns_) return cells;
  for (const auto& row : rows_) cells.push_back(row[column]);
  return cells;
}

bool FirstRows::IsOfNumbers(size_t column) const {
  if (column >= num_columns_ || has_text_[column]) return false;
  return std::ranges::any_of(rows_, [&](const auto& row) { return row[column].has_value(); });
}

}  // namespace trilobe
