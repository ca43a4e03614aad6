#include "io/formats/text/text_table.h"

#include <algorithm>
#include <utility>

#include "io/formats/text/column_words.h"
#include "io/formats/text/table_lines.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

constexpr char kBlanks = ' ';
constexpr char kSeparators[] = {',', ';', '\t', '|', kBlanks};
constexpr int kMostLinesBefore = 200;

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view WithoutQuotes(std::string_view cell) {
  cell = Trimmed(cell);
  for (const char quote : {'"', '\''}) {
    if (cell.size() >= 2 && cell.front() == quote && cell.back() == quote) {
      return Trimmed(cell.substr(1, cell.size() - 2));
    }
  }
  return cell;
}

// Calls `add` with what stands between separators that are in no quotes, or brackets if they count.
template <typename Add>
void SplitOutsideQuotes(std::string_view line, char separator, bool brackets, const Add& add) {
  size_t begin = 0;
  int depth = 0;
  bool quoted = false;
  for (size_t k = 0; k <= line.size(); ++k) {
    const char c = k < line.size() ? line[k] : separator;
    if (c == '"') quoted = !quoted;
    if (brackets && (c == '[' || c == '(')) ++depth;
    if (brackets && (c == ']' || c == ')') && depth > 0) --depth;
    const bool between = separator == kBlanks ? IsSpace(c) || k == line.size() : c == separator;
    if (k < line.size() && (!between || quoted || depth > 0)) continue;
    const std::string_view cell = line.substr(begin, k - begin);
    if (separator != kBlanks || !cell.empty()) add(WithoutQuotes(cell));
    begin = k + 1;
  }
}

// Names of columns; a word in brackets belongs to the one before it.
std::vector<std::string> SplitNames(std::string_view line, char separator) {
  std::vector<std::string> names;
  SplitOutsideQuotes(line, separator, separator == kBlanks, [&](std::string_view cell) {
    const bool in_brackets = cell.starts_with('[') || cell.starts_with('(');
    if (separator == kBlanks && in_brackets && !names.empty()) {
      names.back().append(" ").append(cell);
    } else {
      names.emplace_back(cell);
    }
  });
  if (names.size() > 1 && names.back().empty()) names.pop_back();
  return names;
}

// Context in which names stand.
struct Place {
  bool in_comment, theta_is_given;
};

// Number of names that are known; 0 if they are not those of a table. Prose contains some, too.
int NamesKnown(const std::vector<std::string>& names, char separator, const Place& place) {
  int known = 0;
  bool has_angle = false, has_value = false;
  for (const TableColumn& column : ColumnsNamed(names)) {
    const ColumnRole role = column.role;
    known += role != ColumnRole::kOther ? 1 : 0;
    has_angle |= role == ColumnRole::kThetaI || role == ColumnRole::kThetaO ||
                 role == ColumnRole::kFromMirror ||
                 (role == ColumnRole::kTheta && place.theta_is_given);
    has_value |= role >= ColumnRole::kRed && role <= ColumnRole::kBand;
  }
  const bool is_prose = (place.in_comment && !has_value) ||
                        (separator == kBlanks && 2 * known < static_cast<int>(names.size()));
  return has_angle && known > 1 && !is_prose ? known : 0;
}

// The names in a line, and what is between them.
struct Names {
  std::vector<std::string> names;
  char separator;
};
std::optional<Names> NamesIn(std::string_view line, const Place& place) {
  std::optional<Names> best;
  if (line.starts_with("VARS")) return best;  // of ASTM E1392
  // A line of numbers names no angle.
  if (line.find_first_not_of("0123456789.,;|+-eE \t") == std::string_view::npos) return best;
  int most = 0;
  for (const char separator : kSeparators) {
    // Blanks may stand within names; several tabs, and blanks about them, between two.
    const auto is_empty = [](const std::string& name) { return name.empty(); };
    if (separator == kBlanks && best && std::ranges::none_of(best->names, is_empty)) break;
    std::vector<std::string> names = SplitNames(line, separator);
    const int known = NamesKnown(names, separator, place);
    if (known < most || known == 0) continue;
    if (known == most && names.size() >= best->names.size()) continue;
    most = known;
    best = {std::move(names), separator};
  }
  return best;
}

// Text behind the mark of a comment; none if the line is no comment.
std::optional<std::string_view> CommentOf(std::string_view line) {
  const size_t first = line.find_first_not_of("#%!");
  if (first == 0) return std::nullopt;
  return Trimmed(line.substr(std::min(first, line.size())));
}

bool IsNumber(std::string_view cell) {
  return ToNumber(cell).has_value() || DecimalCommaNumber(cell).has_value();
}

bool HasCells(std::string_view line, size_t fewest) {
  std::vector<std::string_view> cells;
  return std::ranges::any_of(kSeparators, [&](char separator) {
    SplitRow(line, separator, &cells);
    return cells.size() >= fewest;
  });
}

// Whether a line above the rows says how many there are, and is none of them: it has too few cells,
// all of them whole numbers. A negative one behind them marks what is missing (RAMI's `.mes`).
bool IsLineOfCounts(std::string_view line, size_t cells_read) {
  if (HasCells(line, cells_read)) return false;
  if (const size_t minus = line.find_last_of('-'); minus != std::string_view::npos) {
    if (line.find_first_not_of("0123456789.", minus + 1) != std::string_view::npos) return false;
    line = line.substr(0, minus);
  }
  return line.find_first_not_of("0123456789,;| \t") == std::string_view::npos;
}

}  // namespace

void CheckLines(std::string_view text, const std::string& source) {
  constexpr int kMostCells = 100000;
  TextLines lines(text, source);
  while (lines.NextWithComment()) {
    if (lines.line().size() <= kMostCells) continue;
    for (const char separator : kSeparators) {
      if (std::ranges::count(lines.line(), separator) < kMostCells) continue;
      lines.Fail("more than " + std::to_string(kMostCells) + " cells, which no table has",
                 ErrorKind::kLimit, "columns");
    }
  }
}

void SplitRow(std::string_view line, char separator, std::vector<std::string_view>* cells) {
  cells->clear();
  if (line.find('"') != std::string_view::npos || separator == kBlanks) {
    SplitOutsideQuotes(line, separator, /*brackets=*/false,
                       [&](std::string_view cell) { cells->push_back(cell); });
    return;
  }
  for (size_t begin = 0; begin <= line.size();) {
    const size_t end = std::min(line.find(separator, begin), line.size());
    std::string_view cell = line.substr(begin, end - begin);
    if (!cell.empty() && (IsSpace(cell.front()) || IsSpace(cell.back()) || cell.front() == '\'')) {
      cell = WithoutQuotes(cell);
    }
    cells->push_back(cell);
    begin = end + 1;
  }
}

bool LooksLikeRow(std::string_view line, size_t fewest) {
  std::vector<std::string_view> cells;
  return std::ranges::any_of(kSeparators, [&](char separator) {
    SplitRow(line, separator, &cells);
    const auto numbers = static_cast<size_t>(std::ranges::count_if(cells, IsNumber));
    return numbers >= fewest && 2 * numbers >= cells.size();
  });
}

bool IsTableOfNumbers(std::string_view text) {
  constexpr int kMostLinesAbove = 20;
  TextLines lines(text, "");
  for (int k = 0; k <= kMostLinesAbove && lines.Next(); ++k) {
    if (LooksLikeRow(lines.line())) return true;
    if (!lines.line().starts_with('%') && !IsText(lines.line())) return false;
  }
  return false;
}

bool LooksLikeTwoColumns(std::string_view text) {
  constexpr int kMostLines = 100, kFewest = 3;
  TextLines lines(text, "");
  int in_a_row = 0;
  for (int k = 0; k < kMostLines && lines.Next() && in_a_row < kFewest; ++k) {
    in_a_row = LooksLikeRow(lines.line(), 2) ? in_a_row + 1 : 0;
  }
  return in_a_row == kFewest;
}

std::vector<std::string> NamesOfFirstLine(std::string_view line) {
  const auto* const separator = std::ranges::find_if(
      kSeparators, [&](char c) { return c != kBlanks && line.find(c) != std::string_view::npos; });
  return SplitNames(line, separator == std::end(kSeparators) ? kBlanks : *separator);
}

std::optional<TableHead> FindTableHead(std::string_view text, const std::string& source,
                                       bool theta_is_given) {
  std::optional<TableHead> head;  // in a comment
  TextLines lines(text, source);
  for (int before = 0; before < kMostLinesBefore && lines.NextWithComment();) {
    const std::optional<std::string_view> comment = CommentOf(lines.line());
    const std::string_view line =
        comment ? *comment : Trimmed(lines.line().substr(0, lines.line().find('#')));
    std::optional<Names> found;
    if (!AnglesInLine(line)) found = NamesIn(line, {comment.has_value(), theta_is_given});
    if (found) {
      // A column of indices may have no name.
      if (lines.whole_line().starts_with('\t')) found->names.insert(found->names.begin(), "");
      head = {.lines = lines,
              .names = std::move(found->names),
              .separator = found->separator,
              .in_comment = comment.has_value(),
              .lines_before = before};
      if (!comment) break;
    } else if (!comment) {
      if (head && LooksLikeRow(line)) break;
      ++before;
    }
  }
  return head;
}

TableHead TableHeadBy(const std::vector<std::string>& names, std::string_view text,
                      const std::string& source) {
  TableHead by_names{.lines = TextLines(text, source), .names = names};
  if (const std::optional<TableHead> head = FindTableHead(text, source, /*theta_is_given=*/true);
      head && !head->in_comment) {
    by_names.lines = head->lines;
    by_names.lines_before = head->lines_before;
    return by_names;
  }
  size_t read = names.size();
  while (read > 0 && (names[read - 1].empty() || names[read - 1] == "-")) --read;
  const size_t fewest = std::min(names.size(), kFewestNumbers);
  for (TextLines next = by_names.lines; next.Next() && by_names.lines_before < kMostLinesBefore;) {
    if (LooksLikeRow(next.line(), fewest) && !IsLineOfCounts(next.line(), read)) return by_names;
    by_names.lines = next;
    ++by_names.lines_before;
  }
  throw ErrorIn(ErrorKind::kMissing, source, "no line holds numbers for --columns")
      .About("columns");
}

std::vector<size_t> PositionsOf(std::string_view name, const std::vector<std::string>& names) {
  const std::string wanted = Plain(name);
  std::vector<size_t> called, begun;
  for (size_t k = 0; k < names.size(); ++k) {
    std::string plain = Plain(names[k]);
    if (plain == wanted) called.push_back(k);
    TakeBracket(&plain);
    if (Trimmed(plain) == wanted) begun.push_back(k);
  }
  return called.empty() ? begun : called;
}

TableHead TableHeadWith(const std::vector<std::string>& wanted, std::string_view text,
                        const std::string& source) {
  TextLines lines(text, source);
  TableHead best{.lines = lines};
  size_t most = 0;
  for (int before = 0; before < kMostLinesBefore && lines.NextWithComment();) {
    const std::optional<std::string_view> comment = CommentOf(lines.line());
    const std::string_view line = comment ? *comment : lines.line();
    const bool is_row = !comment && LooksLikeRow(line);  // a header of wavelengths may, too
    for (const char separator : kSeparators) {
      std::vector<std::string> names = SplitNames(line, separator);
      const auto found = static_cast<size_t>(std::ranges::count_if(
          wanted, [&](const std::string& name) { return !PositionsOf(name, names).empty(); }));
      if (found <= most || (is_row && found < wanted.size())) continue;
      most = found;
      best = {.lines = lines,
              .names = std::move(names),
              .separator = separator,
              .in_comment = comment.has_value(),
              .lines_before = before};
    }
    if (most == wanted.size() || is_row) break;
    if (!comment) ++before;
  }
  if (most > 0) return best;
  throw ErrorIn(ErrorKind::kMissing, source,
                "no line above the rows names a column '" + wanted.front() + "', as --columns does")
      .About("columns", wanted.front());
}

void GoToRows(TableHead* head) {
  std::vector<std::string_view> cells;
  std::vector<std::string>& names = head->names;
  TextLines next = head->lines;
  if (!next.Next()) return;
  const auto count = [&](char separator) {
    SplitRow(next.line(), separator, &cells);
    if (cells.size() == names.size() + 1 && cells.back().empty()) cells.pop_back();
    return cells.size();
  };
  // In a table of R the rows have names, whose column has none.
  const auto has_row_names = [&] {
    return head->separator != ',' && count(head->separator) == names.size() + 1 &&
           (next.line().starts_with('"') || cells[0] == "1" || cells[0] == "0");
  };
  if (has_row_names()) names.insert(names.begin(), "");
  // "20;0,5" has two cells by its comma, too, and these are no numbers.
  const auto fits = [&](char separator) {
    return count(separator) == names.size() &&
           std::ranges::all_of(cells, [](auto cell) { return IsNumber(cell) || IsGap(cell); });
  };
  const auto other = [&](const auto& is_so) {
    const auto* const found = std::ranges::find_if(kSeparators, is_so);
    return found == std::end(kSeparators) ? head->separator : *found;
  };
  if (!fits(head->separator)) head->separator = other(fits);
  if (count(head->separator) != names.size()) {
    head->separator = other([&](char separator) { return count(separator) == names.size(); });
  }
  const size_t n = count(head->separator);
  const bool is_units = n == names.size() && std::ranges::all_of(cells, [](std::string_view cell) {
                          return cell.empty() || UnitIn(cell);
                        });
  if (!is_units) return;
  for (size_t k = 0; k < n; ++k) {
    if (!cells[k].empty()) names[k] += " [" + *UnitIn(cells[k]) + "]";
  }
  head->lines = next;
}

AnglesInText AnglesBeforeRows(std::string_view text) {
  constexpr int kMostLines = 200;
  TextLines lines(text, "");
  AnglesInText first;
  for (int k = 0; k < kMostLines && lines.NextWithComment(); ++k) {
    const AnglesInText given = AnglesInLine(lines.line());
    if (!first.theta_i) first.theta_i = given.theta_i;
    if (!first.phi_i) first.phi_i = given.phi_i;
    if (!given && LooksLikeRow(WithoutComment(lines.line()))) break;
  }
  return first;
}

}  // namespace trilobe
