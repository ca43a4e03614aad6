#include "solvers/multistart/agreement.h"

#include <algorithm>

namespace trilobe {

int CountAgreeing(std::span<const double> E) {
  if (E.empty()) return 0;
  const double most = (1 + kSameE) * std::ranges::min(E);
  return static_cast<int>(std::ranges::count_if(E, [most](double e) { return e <= most; }));
}

int CountAgreeing(const std::vector<StartResult>& starts) {
  std::vector<double> E;
  for (const StartResult& start : starts) E.push_back(start.objective);
  return CountAgreeing(E);
}

std::string Agreement(const std::vector<StartResult>& starts) {
  return std::to_string(CountAgreeing(starts)) + " of " + std::to_string(starts.size()) +
         " starts agree";
}

}  // namespace trilobe
