#include "io/formats/text/matrix_table.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/text/given_angles.h"
#include "io/formats/text/table_columns.h"
#include "io/formats/text/table_lines.h"
#include "io/formats/text/text_table.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

constexpr size_t kFewestColumns = 2;
constexpr int kMostLinesAbove = 200;

// Angles of the rows and columns of a matrix, as names of columns of a table.
struct Axes {
  std::string row, column;
};

std::optional<Axes> AxesIn(std::string_view cell) {
  const size_t at = cell.find_first_of("/\\");
  if (at == std::string_view::npos) return std::nullopt;
  const Axes axes = {std::string(Trimmed(cell.substr(0, at))),
                     std::string(Trimmed(cell.substr(at + 1)))};
  const auto is_angle = [](const std::string& name) {
    const ColumnRole role = ColumnNamed(name).role;
    return role <= ColumnRole::kPhiO || role == ColumnRole::kTheta || role == ColumnRole::kPhi;
  };
  if (!is_angle(axes.row) || !is_angle(axes.column)) return std::nullopt;
  return axes;
}

// The first number in a cell, "10" of "BRDF at 10 deg" and of "10°".
std::string_view NumberIn(std::string_view cell) {
  const size_t first = std::min(cell.find_first_of("-0123456789"), cell.size());
  const size_t end = std::min(cell.find_first_not_of("-0123456789.,eE", first), cell.size());
  const std::string_view number = cell.substr(first, end - first);
  return ToNumber(number) || DecimalCommaNumber(number) ? number : std::string_view();
}

// The cells of a line that may be part of a matrix; of one with blanks all but the first, which may
// name the axes, are numbers.
std::vector<std::string_view> CellsOf(std::string_view line) {
  std::vector<std::string_view> cells;
  const auto is_number = [](std::string_view cell) {
    return ToNumber(cell) || DecimalCommaNumber(cell);
  };
  for (const char separator : {' ', ';', '\t', ','}) {
    SplitRow(line, separator, &cells);
    if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
    if (cells.size() < kFewestColumns) continue;
    if (separator != ' ' || std::all_of(cells.begin() + 1, cells.end(), is_number)) break;
  }
  return cells;
}

class MatrixRows {
 public:
  MatrixRows(std::string_view text, const std::string& source, std::string_view axes)
      : lines_(text, source), axes_(AxesIn(axes)) {}

  std::string Make() {
    while (lines_.NextWithComment()) {
      const std::string_view line = lines_.line();
      if (line.front() == '#' || line.front() == '%' || AnglesInLine(line)) {
        AddText(line);
        continue;
      }
      const std::vector<std::string_view> cells = CellsOf(line);
      if (IsHeader(cells)) {
        SetColumns(cells);
      } else if (!columns_.empty() && !IsText(line)) {
        AddRow(cells);
      } else if (!axes_ && !LooksForAxes()) {
        return {};
      } else {
        AddText(line);
      }
    }
    return has_values_ ? rows_ : std::string();
  }

 private:
  bool LooksForAxes() const { return lines_.number() < kMostLinesAbove; }

  void AddText(std::string_view line) {
    rows_.append(line).append("\n");
    columns_.clear();  // what follows is another matrix
  }

  // In a header, all cells but the first are numbers, or hold some.
  bool IsHeader(const std::vector<std::string_view>& cells) {
    if (!columns_.empty() || cells.size() < kFewestColumns) return false;
    if (const std::optional<Axes> found = AxesIn(cells[0])) axes_ = found;
    if (!axes_) return false;
    return std::ranges::none_of(cells.begin() + 1, cells.end(),
                                [](auto cell) { return NumberIn(cell).empty(); });
  }

  void SetColumns(const std::vector<std::string_view>& cells) {
    columns_.clear();
    for (const std::string_view cell : cells) columns_.emplace_back(NumberIn(cell));
    if (!has_names_) rows_ += axes_->row + ";" + axes_->column + ";f\n";
    has_names_ = true;
    is_first_row_ = true;
  }

  void AddRow(const std::vector<std::string_view>& cells) {
    // The cell above the rows' angles may be missing.
    if (is_first_row_ && cells.size() == columns_.size() + 1) {
      columns_.insert(columns_.begin(), "");
    }
    is_first_row_ = false;
    if (cells.size() != columns_.size()) {
      lines_.Fail(std::to_string(cells.size()) + " cells in a matrix of " +
                  std::to_string(columns_.size()) + " columns");
    }
    for (size_t k = 1; k < cells.size(); ++k) {
      rows_.append(cells[0]).append(";").append(columns_[k]).append(";");
      rows_.append(cells[k]).append("\n");
      has_values_ = true;
    }
  }

  TextLines lines_;
  std::optional<Axes> axes_;
  std::vector<std::string> columns_;  // the angles above the columns; empty between matrices
  bool is_first_row_ = false, has_names_ = false, has_values_ = false;
  std::string rows_;
};

}  // namespace

bool NamesAxes(std::string_view columns) { return AxesIn(columns).has_value(); }

bool HasAxes(std::string_view text) {
  TextLines lines(text, "");
  for (int k = 0; k < kMostLinesAbove && lines.Next(); ++k) {
    const std::vector<std::string_view> cells = CellsOf(lines.line());
    if (cells.size() >= kFewestColumns && AxesIn(cells[0])) return true;
  }
  return false;
}

std::string RowsOfMatrices(std::string_view text, const std::string& source,
                           std::string_view axes) {
  return MatrixRows(text, source, axes).Make();
}

}  // namespace trilobe
