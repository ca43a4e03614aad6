#include "io/formats/text/table_lines.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "core/files/text_lines.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

// Error values of spreadsheets, in English and German.
constexpr std::string_view kCellErrors[] = {"#N/A",   "#NV",    "#DIV/0!", "#VALUE!",
                                            "#WERT!", "#REF!",  "#BEZUG!", "#NUM!",
                                            "#ZAHL!", "#NAME?", "#NULL!"};
constexpr std::string_view kGaps[] = {"", "-", "--", "NA", "N/A", "n/a", "null", "NULL"};

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

bool TakeUnit(std::string_view unit, std::string_view* cell) {
  if (!cell->ends_with(unit)) return false;
  *cell = Trimmed(cell->substr(0, cell->size() - unit.size()));
  return true;
}

}  // namespace

std::string_view WithoutComment(std::string_view line) {
  for (size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1)) {
    const std::string_view rest = line.substr(at);
    const bool is_error = std::ranges::any_of(
        kCellErrors, [&](std::string_view error) { return rest.starts_with(error); });
    if (!is_error) return Trimmed(line.substr(0, at));
  }
  return line;
}

bool IsGap(std::string_view cell) {
  return std::ranges::find(kGaps, cell) != std::end(kGaps) ||
         std::ranges::find(kCellErrors, cell) != std::end(kCellErrors);
}

std::optional<double> DecimalCommaNumber(std::string_view cell) {
  constexpr size_t kLongest = 64;
  const size_t comma = cell.find(',');
  if (comma == std::string_view::npos || cell.size() > kLongest) return std::nullopt;
  if (cell.find('.') != std::string_view::npos) return std::nullopt;
  std::string with_point(cell);
  with_point[comma] = '.';
  return ToNumber(with_point);
}

std::optional<double> OddNumber(std::string_view cell) {
  constexpr size_t kLongest = 64;
  for (const std::string_view sign : {"°", "º", "\xB0", "deg"}) {
    if (TakeUnit(sign, &cell)) break;
  }
  if (cell.empty() || cell.size() > kLongest) return std::nullopt;
  if (const auto number = ToNumber(cell)) return number;
  const size_t exponent = cell.find_first_of("Dd");
  if (exponent == std::string_view::npos || exponent == 0) return std::nullopt;
  std::string usual(cell);
  usual[exponent] = 'e';
  return ToNumber(usual);
}

std::string WhyNoNumber(std::string_view cell) {
  constexpr size_t kLongest = 40;
  constexpr std::string_view kMarks = ".,'";
  const std::string text = "'" + Printable(cell.substr(0, kLongest)) + "' is no number; ";
  const bool is_digits = cell.find_first_not_of("0123456789.,'+-") == std::string_view::npos;
  const auto marks =
      std::ranges::count_if(cell, [&](char c) { return kMarks.find(c) != std::string_view::npos; });
  if (is_digits && marks > 1) return text + "write numbers without separators of thousands";
  return text + "give the number alone, as 1.5e-3, and an empty cell where nothing was measured";
}

bool IsRule(std::string_view line) {
  return line.find("--") != std::string_view::npos &&
         line.find_first_not_of("-=+|: \t") == std::string_view::npos;
}

bool IsText(std::string_view line) {
  const std::string_view word = line.substr(0, line.find_first_of(" \t,;|=:"));
  return !word.empty() && std::ranges::none_of(word, IsDigit) && !IsGap(word) && !ToNumber(word);
}

}  // namespace trilobe
