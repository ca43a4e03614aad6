#ifndef TRILOBE_SOLVERS_STARTS_SOLVERS_H_
#define TRILOBE_SOLVERS_STARTS_SOLVERS_H_

#include <memory>
#include <string_view>
#include <vector>

#include "trilobe/solvers/solver.h"

namespace trilobe {

// All solvers, the default one first.
const std::vector<SolverEntry>& Solvers();

// Adds a solver from outside the library (docs/adding-a-solver.md). Not thread-safe: call it before
// any other use of the list. Throws Error if the name is empty or taken, `make` is empty, or
// `options` names an unknown option.
void RegisterSolver(SolverEntry entry);

// Both throw Error for an unknown name; the message lists the known ones.
const SolverEntry& FindSolver(std::string_view name);
std::unique_ptr<Solver> MakeSolver(std::string_view name);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_STARTS_SOLVERS_H_
