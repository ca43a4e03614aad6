#include "io/formats/text/given_angles.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/text/table_columns.h"
#include "io/formats/text/table_lines.h"
#include "trilobe/core/base/angles.h"

namespace trilobe {
namespace {

constexpr std::string_view kBetween = "=:;,\t \"";
constexpr std::string_view kDigits = "0123456789";

bool IsBetweenWords(char c) { return kBetween.find(c) != std::string_view::npos; }

std::string_view WithoutEnds(std::string_view text) {
  while (!text.empty() && IsBetweenWords(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsBetweenWords(text.back())) text.remove_suffix(1);
  return text;
}

// "theta_i = 30 deg": what stands before a number, the number, and its unit.
struct Assignment {
  std::string_view name;
  bool by_equals = false;
  double number = 0;
  std::optional<std::string> unit = {};
};

// Takes one off the text; none where it begins with something else.
std::optional<Assignment> TakeAssignment(std::string_view* text) {
  const size_t first = text->find_first_of(kDigits);
  if (first == std::string_view::npos || first == 0) return std::nullopt;
  std::string_view before = text->substr(0, first);
  const bool is_negative = before.back() == '-';
  if (is_negative) before.remove_suffix(1);
  if (before.empty() || !IsBetweenWords(before.back())) return std::nullopt;  // "x30"
  const size_t end = std::min(text->find_first_not_of("0123456789.,", first), text->size());
  std::string_view digits = text->substr(first, end - first);
  while (digits.back() == ',' || digits.back() == '.') digits.remove_suffix(1);
  std::optional<double> number = ToNumber(digits);
  if (!number) number = DecimalCommaNumber(digits);
  if (!number) return std::nullopt;
  const size_t name_end = before.find_last_not_of(kBetween) + 1;  // 0 without a name
  Assignment assignment = {.name = WithoutEnds(before),
                           .by_equals = before.find('=', name_end) != std::string_view::npos,
                           .number = is_negative ? -*number : *number};
  text->remove_prefix(first + digits.size());
  // A unit, in brackets or not.
  const size_t unit_at = std::min(text->find_first_not_of(" \t"), text->size());
  const size_t unit_end = std::min(text->find_first_of(" \t,;\"", unit_at), text->size());
  assignment.unit = UnitIn(text->substr(unit_at, unit_end - unit_at));
  if (assignment.unit) text->remove_prefix(unit_end);
  if (!text->empty() && !IsBetweenWords(text->front())) return std::nullopt;  // "30x"
  return assignment;
}

TableColumn ColumnOf(const Assignment& assignment) {
  TableColumn column = ColumnNamed(assignment.name);
  if (column.role == ColumnRole::kOther && assignment.by_equals) {  // "incident angle theta_in ="
    column = ColumnNamed(assignment.name.substr(assignment.name.find_last_of(" \t") + 1));
  }
  if (assignment.unit) column.unit = *assignment.unit;
  return column;
}

}  // namespace

AnglesInText AnglesInLine(std::string_view line) {
  constexpr size_t kLongest = 200;
  while (!line.empty() && (line.front() == '#' || line.front() == '%')) line.remove_prefix(1);
  line = Trimmed(line);
  if (line.empty() || line.size() > kLongest) return {};
  AnglesInText angles;
  for (line = WithoutEnds(line); !line.empty(); line = WithoutEnds(line)) {
    const std::optional<Assignment> assignment = TakeAssignment(&line);
    if (!assignment) return {};
    const TableColumn column = ColumnOf(*assignment);
    // Of "incidence angle: 45 deg, azimuth: 90 deg".
    const bool is_phi = column.role == ColumnRole::kPhiI ||
                        (column.role == ColumnRole::kPhi && angles.theta_i.has_value());
    const bool is_theta = column.role == ColumnRole::kThetaI;
    if (!is_phi && !is_theta) {
      if (assignment->by_equals) continue;
      return {};
    }
    const std::optional<double> unit = RadiansIn(column.unit);
    if (!unit || (is_theta && assignment->number < 0)) return {};
    const double radians = assignment->number * *unit;
    (is_theta ? angles.theta_i : angles.phi_i) = column.from_horizon ? kPi / 2 - radians : radians;
  }
  return angles;
}

}  // namespace trilobe
