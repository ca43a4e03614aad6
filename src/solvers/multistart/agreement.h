#ifndef TRILOBE_SOLVERS_MULTISTART_AGREEMENT_H_
#define TRILOBE_SOLVERS_MULTISTART_AGREEMENT_H_

#include <span>
#include <string>
#include <vector>

#include "trilobe/solvers/solver.h"

namespace trilobe {

inline constexpr double kSameE = 0.005;  // E of models that agree differ by this share at most

// How many have the least E, within kSameE. Two that came there from different starts are hardly
// there by chance.
int CountAgreeing(std::span<const double> E);
int CountAgreeing(const std::vector<StartResult>& starts);

// The same for a report: "2 of 2 starts agree".
std::string Agreement(const std::vector<StartResult>& starts);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_MULTISTART_AGREEMENT_H_
