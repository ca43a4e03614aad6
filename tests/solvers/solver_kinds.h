#ifndef TRILOBE_TESTS_SOLVERS_SOLVER_KINDS_H_
#define TRILOBE_TESTS_SOLVERS_SOLVER_KINDS_H_

#include <algorithm>

#include "trilobe/solvers/solver.h"

namespace trilobe {

// Whether a solver updates element by element, as AWLS does: with SolverOptions::on_element and a
// filter on G.
inline bool UpdatesElements(const SolverEntry& solver) {
  return std::ranges::count(solver.options, "g_filter_sigma") > 0;
}

// Ceres adds up the cost, on which its decisions depend, in the order in which threads finish.
inline bool SameBitsForAnyThreads(const SolverEntry& solver) { return solver.name != "lm_plain"; }

}  // namespace trilobe

#endif  // TRILOBE_TESTS_SOLVERS_SOLVER_KINDS_H_
