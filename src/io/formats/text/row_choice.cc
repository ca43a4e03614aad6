#include "io/formats/text/row_choice.h"

#include <algorithm>

#include "io/formats/text/table_lines.h"
#include "io/formats/text/text_table.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

constexpr size_t kMostOthers = 5;

bool IsSameCell(std::string_view a, std::string_view b) {
  return a == b || (ToNumber(a) && ToNumber(a) == ToNumber(b));
}

}  // namespace

RowChoice::RowChoice(const std::string& rows, const std::vector<std::string>& columns,
                     const TextLines& header)
    : rows_(rows), header_(header) {
  if (rows.empty()) return;
  for (const std::string_view part : SplitCells(rows)) {
    const size_t at = part.find('=');
    if (at == std::string_view::npos) {
      header.Fail("--rows=" + rows + ": give a column and a cell of it, as polarization=s",
                  ErrorKind::kFormat, "rows", rows);
    }
    const std::string_view name = Trimmed(part.substr(0, at));
    const std::vector<size_t> found = PositionsOf(name, columns);
    if (found.size() != 1) {
      header.Fail("--rows=" + rows + ": there " + (found.empty() ? "is no" : "are several") +
                      (found.empty() ? " column '" : " columns '") + std::string(name) + "'",
                  found.empty() ? ErrorKind::kUnknown : ErrorKind::kConflict, "rows", name);
    }
    parts_.push_back({found[0], std::string(Trimmed(part.substr(at + 1)))});
  }
}

std::vector<size_t> RowChoice::columns() const {
  std::vector<size_t> columns;
  for (const Part& part : parts_) columns.push_back(part.column);
  return columns;
}

bool RowChoice::Takes(const TextLines& lines, TableRow* row) {
  asked_ = true;
  for (Part& part : parts_) {
    const std::string_view cell = row->Cell(lines, part.column);
    if (IsSameCell(cell, part.cell)) continue;
    if (part.others.size() <= kMostOthers &&
        std::ranges::find(part.others, cell) == part.others.end()) {
      part.others.emplace_back(cell);
    }
    return false;
  }
  taken_ = true;
  return true;
}

void RowChoice::CheckTaken() const {
  if (!asked_ || taken_) return;
  std::string there;
  for (const Part& part : parts_) {
    for (size_t k = 0; k < std::min(part.others.size(), kMostOthers); ++k) {
      there += (there.empty() ? "" : ", ") + Printable(part.others[k]);
    }
    if (part.others.size() > kMostOthers) there += ", ...";
  }
  header_.Fail("no row is of --rows=" + rows_ + "; there are " + there, ErrorKind::kMissing, "rows",
               rows_);
}

}  // namespace trilobe
