#ifndef TRILOBE_APP_SOLVER_FLAGS_H_
#define TRILOBE_APP_SOLVER_FLAGS_H_

#include <string>
#include <vector>

#include "trilobe/model/model_spec.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// --solver. Throws Error that lists the known names.
const SolverEntry& SolverFromFlags();

// Makes a flag of each option of AllSolverOptions() that has none. Before flags are parsed.
void DefineSolverFlags();

// The flags that stand for SolverOptions: those that every solver reads, and those that only some
// do.
std::vector<std::string> CommonSolverFlags();
std::vector<std::string> ParticularSolverFlags();

// The options that the flags ask for. `spec` turns the degrees of --g_filter into nodes of G.
// Throws Error for a value that makes no sense, and for a flag that this solver does not read.
SolverOptions SolverOptionsFromFlags(const SolverEntry& solver, const ModelSpec& spec);

// Some lines for people: name, description, reference, and the flags of this solver alone.
std::string DescribeSolver(const SolverEntry& solver);

}  // namespace trilobe

#endif  // TRILOBE_APP_SOLVER_FLAGS_H_
