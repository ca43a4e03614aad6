#ifndef TRILOBE_APP_SOLVER_FLAGS_H_
#define TRILOBE_APP_SOLVER_FLAGS_H_

#include <functional>
#include <string>
#include <vector>

#include "trilobe/model/model_spec.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// The solver of --solver. Throws Error for an unknown name; the message lists the known ones.
const SolverEntry& SolverFromFlags();

// Defines a flag for each option of AllSolverOptions() without one. Call it before flags are
// parsed.
void DefineSolverFlags();

// Flags of SolverOptions that every solver reads, and those that only some read.
std::vector<std::string> CommonSolverFlags();
std::vector<std::string> ParticularSolverFlags();

// Options by the flags as they are now, for any spec. Throws Error as SolverOptionsFromFlags does;
// what it returns throws for values that are bad for its spec.
std::function<SolverOptions(const ModelSpec& spec)> SolverOptionsByFlags(const SolverEntry& solver);

// Whether the solver reads a flag that only some solvers read.
bool TakesFlag(const SolverEntry& solver, const std::string& flag);

// Options by the flags. `spec` converts the degrees of --g_filter to nodes of G. Throws Error for
// bad values and for flags that this solver does not read.
SolverOptions SolverOptionsFromFlags(const SolverEntry& solver, const ModelSpec& spec);

// Help text: name, description, reference, and the flags that only some solvers read.
std::string DescribeSolver(const SolverEntry& solver);

}  // namespace trilobe

#endif  // TRILOBE_APP_SOLVER_FLAGS_H_
