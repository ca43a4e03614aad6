#ifndef TRILOBE_CORE_BASE_QUANTILE_H_
#define TRILOBE_CORE_BASE_QUANTILE_H_

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace trilobe {

// The quantile of some values, of which there must be at least one, for a share from 0 to 1; always
// one of the values. Reorders them.
inline double Quantile(std::vector<double>* values, double share) {
  const auto at = values->begin() +
                  static_cast<std::ptrdiff_t>(share * static_cast<double>(values->size() - 1));
  std::ranges::nth_element(*values, at);
  return *at;
}

// The same where values[k] counts weights[k] times, which is above 0. One of the values, and equal
// weights are none.
inline double WeightedQuantile(std::vector<double> values, const std::vector<double>& weights,
                               double share) {
  const auto is_first = [&](double weight) { return weight == weights.front(); };
  if (std::ranges::all_of(weights, is_first)) return Quantile(&values, share);
  std::vector<size_t> order(values.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, {}, [&](size_t k) { return values[k]; });
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  const double place = share * (sum - sum / static_cast<double>(weights.size()));
  double below = 0;
  size_t at = order.front();
  for (const size_t k : order) {
    if (below > place) break;
    at = k;
    below += weights[k];
  }
  return values[at];
}

// The middle one of some values, of which there must be at least one; of an even number the upper
// of the two in the middle, so that it is one of the values.
inline double UpperMedian(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// The median of some values, of which there must be at least one; of an even number the mean of the
// two in the middle, which is infinite if one of them is.
inline double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return std::midpoint(*std::max_element(values.begin(), middle), *middle);
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_QUANTILE_H_
