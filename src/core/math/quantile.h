#ifndef TRILOBE_CORE_MATH_QUANTILE_H_
#define TRILOBE_CORE_MATH_QUANTILE_H_

#include <algorithm>
#include <cstddef>
#include <vector>

namespace trilobe {

// The value below which a share, from 0 to 1, of some values lies: one of them, of which there is
// one at least. Reorders them.
inline double Quantile(std::vector<double>* values, double share) {
  const auto at = values->begin() +
                  static_cast<std::ptrdiff_t>(share * static_cast<double>(values->size() - 1));
  std::ranges::nth_element(*values, at);
  return *at;
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_MATH_QUANTILE_H_
