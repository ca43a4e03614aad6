#include "io/formats/text/table_lines.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

#include "core/files/text_lines.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

// Error values of spreadsheets, in English and German.
constexpr std::string_view kCellErrors[] = {"#N/A",   "#NV",    "#DIV/0!", "#VALUE!",
                                            "#WERT!", "#REF!",  "#BEZUG!", "#NUM!",
                                            "#ZAHL!", "#NAME?", "#NULL!"};
constexpr std::string_view kGaps[] = {"", "-", "--", "NA", "N/A", "n/a", "null", "NULL"};

// In lower case.
constexpr std::string_view kMoreGaps[] = {"none", "nd", "n.d.", "n.a.", "."};

bool IsEmptyMark(std::string_view cell) {
  return std::ranges::find(kGaps, cell) != std::end(kGaps) ||
         std::ranges::find(kCellErrors, cell) != std::end(kCellErrors);
}

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
  constexpr size_t kLongest = 4;
  if (IsEmptyMark(cell)) return true;
  if (cell.find_first_not_of('*') == std::string_view::npos) return true;  // too narrow a cell
  if (cell.size() > kLongest) return false;
  std::string lower(cell);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::ranges::find(kMoreGaps, lower) != std::end(kMoreGaps);
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

bool IsEmptyRow(std::string_view line) {
  return line.find_first_not_of(",;|\" \t") == std::string_view::npos;
}

bool IsText(std::string_view line) {
  const std::string_view word = line.substr(0, line.find_first_of(" \t,;|=:"));
  return !word.empty() && std::ranges::none_of(word, IsDigit) && !IsEmptyMark(word) &&
         !ToNumber(word);
}

std::string WithPlainSigns(std::string_view text) {
  constexpr std::pair<std::string_view, char> kSigns[] = {
      {"\u2212", '-'}, {"\u00A0", ' '}, {"\u2007", ' '}, {"\u2009", ' '}, {"\u202F", ' '}};
  std::string plain;
  size_t begin = 0;
  for (size_t at = 0; at < text.size();) {
    const std::string_view rest = text.substr(at);
    // The blank that does not break, alone in Latin-1.
    const bool is_latin =
        rest.front() == '\xA0' && (at == 0 || static_cast<unsigned char>(text[at - 1]) < 0x80U);
    const auto* const sign = std::ranges::find_if(
        kSigns, [&](const auto& entry) { return rest.starts_with(entry.first); });
    if (!is_latin && sign == std::end(kSigns)) {
      ++at;
      continue;
    }
    plain += text.substr(begin, at - begin);
    plain += is_latin ? ' ' : sign->second;
    at += is_latin ? 1 : sign->first.size();
    begin = at;
  }
  return plain.append(text.substr(begin));
}

bool HasOddSigns(std::string_view text) {
  return text.find('\xE2') != std::string_view::npos || text.find('\xA0') != std::string_view::npos;
}

}  // namespace trilobe
