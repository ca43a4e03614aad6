#ifndef TRILOBE_TESTS_SOLVERS_SOLVER_KINDS_H_
#define TRILOBE_TESTS_SOLVERS_SOLVER_KINDS_H_

#include <algorithm>
#include <vector>

#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {

// The library's own solvers: copied before main, so without those that tests register.
inline const std::vector<SolverEntry> kLibrarySolvers = Solvers();

// Whether each sweep of a solver updates all parameters one by one, in their order.
inline bool UpdatesElements(const SolverEntry& solver) {
  return solver.name == "awls" || solver.name == "awls_literal";
}

// Whether a solver refuses scattered samples: as it was published, it knows a grid alone.
inline bool NeedsAGrid(const SolverEntry& solver) { return solver.name == "awls_gss"; }

// Whether a solver reports its updates within an iteration to SolverOptions::on_element.
inline bool ReportsUpdates(const SolverEntry& solver) {
  return UpdatesElements(solver) || solver.name == "awls_block" ||
         solver.name == "awls_accelerated" || solver.name == "awls_gss";
}

// Whether a solver finds its way whatever the unit of the data: the example of
// docs/adding-a-solver.md, for those who follow it, tries steps of 1 from parameters that are 0.
inline bool KnowsUnits(const SolverEntry& solver) { return solver.name != "compass_search"; }

// Whether the filter comes after a sweep, so that E may rise; in awls_gss it is part of a step that
// does not raise E.
inline bool FiltersG(const SolverEntry& solver) {
  return solver.name != "awls_gss" && std::ranges::count(solver.options, "g_filter_sigma") > 0;
}

// Ceres adds up the cost, on which its decisions depend, in the order in which threads finish.
inline bool SameBitsForAnyThreads(const SolverEntry& solver) { return solver.name != "lm_plain"; }

}  // namespace trilobe

#endif  // TRILOBE_TESTS_SOLVERS_SOLVER_KINDS_H_
