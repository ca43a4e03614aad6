#include "io/formats/text/table_head.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/text/columns_flag.h"
#include "io/formats/text/given_angles.h"
#include "io/formats/text/table_columns.h"
#include "io/formats/text/table_lines.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

// "theta_i=Angle": what a column holds, and its name in the header, "" in a list of all columns.
struct NamedColumn {
  std::string what, in_header;
};

std::vector<NamedColumn> NamedColumns(const std::string& columns) {
  const bool by_header = columns.find('=') != std::string::npos;
  std::vector<NamedColumn> named;
  for (const std::string_view cell : SplitCells(columns)) {
    const size_t at = std::min(cell.find('='), cell.size());
    const std::string_view in_header = at == cell.size() ? cell : cell.substr(at + 1);
    named.push_back({std::string(Trimmed(cell.substr(0, at))),
                     by_header ? std::string(Trimmed(in_header)) : std::string()});
    if (!by_header || !named.back().in_header.empty()) continue;
    throw Error(ErrorKind::kUnknown,
                "--columns=" + columns + ": '" + std::string(cell) +
                    "' names no column of the header; write theta_i=NAME,f=NAME")
        .About("columns", cell);
  }
  return named;
}

bool IsByHeader(const std::vector<NamedColumn>& named) {
  return !named.empty() && !named.front().in_header.empty();
}

std::string Listed(const std::vector<std::string>& names) {
  constexpr size_t kMost = 12;
  std::string text;
  for (size_t k = 0; k < std::min(names.size(), kMost); ++k) {
    text += (k > 0 ? ", '" : "'") + Printable(names[k]) + "'";
  }
  return text + (names.size() > kMost ? ", ..." : "");
}

// Numbers of a line, whatever is between them.
std::vector<double> NumbersIn(std::string_view line) {
  std::vector<double> numbers;
  std::vector<std::string_view> cells;
  for (const char separator : {';', '\t', ' ', ','}) {
    SplitRow(line, separator, &cells);
    numbers.clear();
    for (const std::string_view cell : cells) {
      const std::optional<double> number =
          ToNumber(cell) ? ToNumber(cell) : DecimalCommaNumber(cell);
      if (number) numbers.push_back(*number);
    }
    if (numbers.size() == cells.size() && numbers.size() > 1) return numbers;
  }
  return {};
}

// Advice on lines of numbers, of which the first is at `lines`, that are no rows of samples: those
// of one spectrum, or of several lines for each pair of directions. Else "".
std::string AdviceOnNumbers(TextLines lines) {
  constexpr int kMostLines = 30;
  constexpr double kShortest = 200, kLongest = 3000;  // [nm]
  std::vector<std::vector<double>> rows;
  do {
    rows.push_back(NumbersIn(lines.line()));
  } while (static_cast<int>(rows.size()) < kMostLines && lines.Next());
  const bool are_pairs = std::ranges::all_of(rows, [](const auto& row) { return row.size() == 2; });
  const auto ascends = [&] {
    return std::ranges::adjacent_find(
               rows, [](const auto& a, const auto& b) { return a[0] >= b[0]; }) == rows.end();
  };
  if (are_pairs && rows.size() > 2 && rows.front()[0] >= kShortest && rows.back()[0] <= kLongest &&
      ascends()) {
    return "these seem to be wavelengths and values of one pair of directions, which the file does "
           "not name; a fit needs many pairs: put all files into one table with the header "
           "theta_i,theta_o,phi_o,wavelength,f";
  }
  // Two angles, then a line of readings or of wavelengths, or both, of another length.
  const bool are_blocks =
      rows.size() > 5 && std::ranges::all_of(rows, [](const auto& row) { return !row.empty(); }) &&
      rows[0].size() == 2 && rows[1].size() > 3 && (rows[2].size() == 2 || rows[3].size() == 2);
  if (!are_blocks) return "";
  return "these seem to be blocks, each of a line of two angles and " +
         std::string(rows[2].size() == 2 ? "one" : "two") + " of " +
         std::to_string(rows[1].size()) +
         " numbers; make it a table of a row a block, with the header theta_i,theta_o,phi_o and "
         "the "
         "wavelengths, as 550nm; readings of a detector become a BRDF by those of a white of known "
         "reflectance at the same angles: f = reading / reading of the white * its reflectance / "
         "pi";
}

}  // namespace

namespace {

bool IsNoHeader(std::string_view line) { return AnglesInLine(line) || line.starts_with('['); }

// The number of cells of the first rows, of which one may be a line of counts.
size_t CellsOfRows(TextLines lines) {
  size_t cells = NamesOfFirstLine(lines.line()).size();
  if (lines.Next()) cells = std::max(cells, NamesOfFirstLine(lines.line()).size());
  return cells;
}

// From the first line of a text to the last above the numbers, which may be a header of unknown
// names, or else to the first of numbers. Stays where there are none.
void GoToLastText(TextLines* lines) {
  constexpr int kMostLines = 200;
  std::optional<TextLines> last;
  TextLines next = *lines;
  for (int k = 0; k < kMostLines && !LooksLikeRow(next.line(), 2); ++k) {
    if (!IsNoHeader(next.line())) last = next;
    if (!next.Next()) return;
  }
  if (LooksLikeRow(next.line(), 2)) *lines = last.value_or(next);
}

}  // namespace

TableHead HeadOf(std::string_view text, const std::string& source, const std::string& columns,
                 bool theta_is_given) {
  TableHead head{.lines = TextLines(text, source)};
  if (!columns.empty()) {
    const std::vector<NamedColumn> named = NamedColumns(columns);
    const bool by_header = IsByHeader(named);
    std::vector<std::string> names;
    for (const NamedColumn& column : named) {
      names.push_back(by_header ? column.in_header : column.what);
    }
    head = by_header ? TableHeadWith(names, text, source) : TableHeadBy(names, text, source);
  } else if (auto found = FindTableHead(text, source, theta_is_given)) {
    head = *std::move(found);
  } else if (auto other = FindTableHead(text, source, /*theta_is_given=*/true)) {
    head = *std::move(other);  // the layout says what is missing
  } else {
    if (!head.lines.Next()) {
      throw ErrorIn(
          ErrorKind::kFormat, source,
          std::string("the file is empty; a table begins with a header row, as ") + kUsualColumns)
          .About("content", "empty");
    }
    while (head.lines.line().starts_with('%') && head.lines.Next()) {
    }
    GoToLastText(&head.lines);
    constexpr size_t kOfCuret = 206;  // a sample's number, and its value at each direction
    if (SplitCells(head.lines.line(), ' ').size() == kOfCuret) {
      head.lines.Fail(
          "a line of 206 numbers, as CUReT's list of 61 samples at 205 directions has them, which "
          "another file names: make a table a sample, theta_i,phi_i,theta_o,phi_o,f");
    }
    if (const std::string advice = AdviceOnNumbers(head.lines); !advice.empty()) {
      head.lines.Fail(advice, ErrorKind::kUnsupported, "columns");
    }
    if (LooksLikeRow(head.lines.line(), 2)) {
      head.lines.Fail(
          "no header row names the columns; --columns=" + ExampleColumns(CellsOfRows(head.lines)) +
          " names them, - those to leave out, and --columns=theta_o/phi_o the rows and "
          "columns of a matrix");
    }
    head.names = NamesOfFirstLine(head.lines.line());
  }
  return head;
}

namespace {

bool IsValue(ColumnRole role) { return role >= ColumnRole::kRed && role <= ColumnRole::kBand; }

// Whether a column that is named takes the place of one that the header calls so.
bool TakesPlaceOf(ColumnRole named, ColumnRole other) {
  using Role = ColumnRole;
  if (IsValue(named)) return IsValue(other);
  switch (named) {
    case Role::kThetaO:
    case Role::kFromMirror:
      return other == Role::kThetaO || other == Role::kTheta || other == Role::kFromMirror;
    case Role::kThetaI:
      return other == Role::kThetaI;
    case Role::kPhiO:
    case Role::kPhi:
    case Role::kPhase:
      return other == Role::kPhiO || other == Role::kPhi || other == Role::kPhase;
    default:
      return named == other && named != Role::kOther;
  }
}

}  // namespace

std::vector<TableColumn> ColumnsOf(const TableHead& head, const TextLines& header,
                                   const std::string& columns) {
  const std::vector<NamedColumn> named = NamedColumns(columns);
  if (!IsByHeader(named)) {
    std::vector<TableColumn> all = ColumnsNamed(head.names);
    for (TableColumn& column : all) column.is_by_flag = !columns.empty();
    return all;
  }
  std::vector<std::string> whats(head.names.size());
  for (const auto& [what, in_header] : named) {
    const std::vector<size_t> at = PositionsOf(in_header, head.names);
    const std::string begin = "--columns names '" + in_header + "', ";
    if (at.empty()) {
      header.Fail(begin + "and the header has " + Listed(head.names), ErrorKind::kUnknown,
                  "columns", in_header);
    }
    if (at.size() > 1) {
      header.Fail(begin + "which the header has " + std::to_string(at.size()) +
                      " times; name all columns in their order, as " +
                      ExampleColumns(head.names.size()),
                  ErrorKind::kConflict, "columns", in_header);
    }
    if (!whats[at[0]].empty()) header.Fail(begin + "twice", ErrorKind::kConflict, "columns", what);
    const std::string unit = ColumnNamed(head.names[at[0]]).unit;
    whats[at[0]] = what;
    if (unit == "db" || (!unit.empty() && RadiansIn(unit))) whats[at[0]] += " [" + unit + "]";
  }
  // The other columns keep the meaning of their names.
  const std::vector<TableColumn> by_flag = ColumnsNamed(whats), by_name = ColumnsNamed(head.names);
  std::vector<std::string> names = whats;
  for (size_t k = 0; k < names.size(); ++k) {
    const bool is_replaced = std::ranges::any_of(by_flag, [&](const TableColumn& column) {
      return TakesPlaceOf(column.role, by_name[k].role);
    });
    if (whats[k].empty()) names[k] = is_replaced ? "-" : head.names[k];
  }
  std::vector<TableColumn> found = ColumnsNamed(names);
  for (size_t k = 0; k < found.size(); ++k) {
    found[k].name = head.names[k];
    found[k].is_by_flag = !whats[k].empty();
  }
  return found;
}

void CheckNames(const std::string& columns) {
  if (columns.empty()) return;
  std::vector<std::string> whats;
  for (const NamedColumn& column : NamedColumns(columns)) whats.push_back(column.what);
  for (const TableColumn& column : ColumnsNamed(whats)) {
    if (column.role != ColumnRole::kOther || column.name.empty() || column.name == "-") continue;
    throw Error(ErrorKind::kUnknown,
                "--columns=" + columns + ": '" + column.name +
                    "' says of no column what it holds; known are theta_i, phi_i, theta_o, phi_o, "
                    "elevation_i, elevation_o, from_mirror, phase, r, g, b, f, 550nm, wavelength, "
                    "db, log10 and ln; - leaves a column out, "
                    "and theta_i=NAME names one of the header")
        .About("columns", column.name);
  }
}

}  // namespace trilobe
