#include "core/base/names.h"

#include <algorithm>
#include <numeric>

namespace trilobe {

size_t EditDistance(std::string_view a, std::string_view b) {
  // rows[i][j]: from the first i characters of `a` to the first j of `b`.
  std::vector<std::vector<size_t>> rows(a.size() + 1, std::vector<size_t>(b.size() + 1));
  std::iota(rows[0].begin(), rows[0].end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    rows[i][0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t replaced = rows[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      rows[i][j] = std::min({replaced, rows[i - 1][j] + 1, rows[i][j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) rows[i][j] = std::min(rows[i][j], rows[i - 2][j - 2] + 1);
    }
  }
  return rows[a.size()][b.size()];
}

std::string_view NearestName(std::string_view name, const std::vector<std::string_view>& known) {
  return *std::ranges::min_element(
      known, {}, [name](std::string_view candidate) { return EditDistance(name, candidate); });
}

std::string MeantName(std::string_view name, const std::vector<std::string_view>& known) {
  if (known.empty()) return "";
  const std::string_view nearest = NearestName(name, known);
  return 3 * EditDistance(name, nearest) <= name.size() ? std::string(nearest) : "";
}

Error UnknownName(std::string_view what, std::string_view name,
                  const std::vector<std::string_view>& known) {
  std::string names;
  for (const std::string_view one : known) names += (names.empty() ? "" : ", ") + std::string(one);
  const std::string meant = MeantName(name, known);
  return Error(ErrorKind::kUnknown, "unknown " + std::string(what) + " '" + std::string(name) +
                                        "'; known: " + names +
                                        (meant.empty() ? "" : "; did you mean '" + meant + "'?"))
      .About(what, name);
}

}  // namespace trilobe
