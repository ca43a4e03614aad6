#include "io/formats/text/angle_list.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>

namespace trilobe {

std::vector<double> ReadNumbersOfLine(const TextLines& lines, size_t count, const char* what) {
  const std::vector<std::string> names(count, what);
  std::vector<double> numbers;
  ReadNumbers(lines, SplitWords(lines.line()), names, &numbers);
  return numbers;
}

std::vector<double> ReadAngleList(const AngleList& list, std::string_view count_text,
                                  TextLines* lines) {
  const std::optional<double> count = ToNumber(count_text);
  constexpr double kMost = 10000;
  if (!count || !(*count >= 1 && *count <= kMost) || *count != std::floor(*count)) {
    lines->Fail(std::string("expected the number of angles after ") + list.key, ErrorKind::kFormat,
                list.key);
  }
  if (!lines->Next()) {
    lines->Fail(std::string("the angles of ") + list.key + " are missing", ErrorKind::kMissing,
                list.key);
  }
  std::vector<double> angles = ReadNumbersOfLine(*lines, static_cast<size_t>(*count), list.key);
  for (size_t k = 0; k < angles.size(); ++k) {
    std::ostringstream problem;
    if (!(angles[k] >= list.min_deg && angles[k] <= list.max_deg)) {
      problem << angles[k] << " is no such angle; expected degrees from " << list.min_deg << " to "
              << list.max_deg;
    } else if (k > 0 && !(angles[k] > angles[k - 1])) {
      problem << angles[k] << " must be above the angle before it, " << angles[k - 1];
    } else {
      continue;
    }
    lines->FailAt(k, list.key, problem.str(), ErrorKind::kRange, FactText(angles[k]));
  }
  return angles;
}

size_t Distinct(const std::vector<double>& degrees) {
  return degrees.size() - (degrees.size() > 1 && degrees.back() - degrees.front() == 360 ? 1 : 0);
}

BetweenNodes FindBetween(const std::vector<double>& nodes, double x) {
  if (nodes.size() == 1) return {};
  const auto above = std::ranges::upper_bound(nodes, x) - nodes.begin();
  const size_t lower = std::clamp<ptrdiff_t>(above, 1, std::ssize(nodes) - 1) - 1;
  const double t = (x - nodes[lower]) / (nodes[lower + 1] - nodes[lower]);
  return {lower, std::clamp(t, 0.0, 1.0)};
}

}  // namespace trilobe
