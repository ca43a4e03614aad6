#include "core/base/names.h"

#include <algorithm>
#include <numeric>

namespace trilobe {

size_t EditDistance(std::string_view a, std::string_view b) {
  // row[j]: from the characters of `a` so far to the first j of `b`.
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::string_view NearestName(std::string_view name, const std::vector<std::string_view>& known) {
  return *std::ranges::min_element(
      known, {}, [name](std::string_view candidate) { return EditDistance(name, candidate); });
}

}  // namespace trilobe
