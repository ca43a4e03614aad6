#ifndef TRILOBE_SOLVERS_OPTION_VALUES_H_
#define TRILOBE_SOLVERS_OPTION_VALUES_H_

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "trilobe/solvers/solver.h"

namespace trilobe {

// A member of SolverOptions by its name, for reports. Choices are given by their names.
struct OptionValue {
  std::string name;
  std::variant<bool, int, uint64_t, double, std::string> value;

  bool operator==(const OptionValue&) const = default;
};

// The options that all solvers read and those of `particular` (SolverEntry::options), in the order
// of SolverOptions; callbacks have no value and are left out.
std::vector<OptionValue> OptionValues(const SolverOptions& options,
                                      std::span<const std::string> particular);

// "60", "0.001", "true", "active_set".
std::string ToText(const OptionValue& option);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_OPTION_VALUES_H_
