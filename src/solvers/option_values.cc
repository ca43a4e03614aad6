#include "trilobe/solvers/option_values.h"

#include <algorithm>
#include <sstream>

namespace trilobe {

std::vector<OptionValue> OptionValues(const SolverOptions& options,
                                      std::span<const std::string> particular) {
  std::vector<OptionValue> values = {
      {"max_iterations", options.max_iterations},
      {"max_seconds", options.max_seconds},
      {"relative_decrease_tolerance", options.relative_decrease_tolerance},
      {"optimality_tolerance", options.optimality_tolerance},
      {"diagnose", options.diagnose}};
  const OptionValue others[] = {{"g_filter_sigma", options.g_filter_sigma},
                                {"positivity", PositivityName(options.positivity)},
                                {"trust_region", TrustRegionName(options.trust_region)},
                                {"memory", options.memory},
                                {"starts", options.starts},
                                {"seed", options.seed}};
  for (const OptionValue& other : others) {
    if (std::ranges::find(particular, other.name) != particular.end()) values.push_back(other);
  }
  return values;
}

std::string ToText(const OptionValue& option) {
  std::ostringstream out;
  out << std::boolalpha;
  std::visit([&out](const auto& value) { out << value; }, option.value);
  return out.str();
}

}  // namespace trilobe
