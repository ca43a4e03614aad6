#include "trilobe/solvers/starts/solvers.h"

#include <utility>

#include "core/base/names.h"
#include "trilobe/core/base/error.h"

// The solvers of the library, the default one first. NAME stands for the function NAMEEntry(),
// which the solver's own file defines: to add a solver is one file, and one line here.
#define TRILOBE_FOR_EACH_SOLVER(X) \
  X(Auto)                          \
  X(Multistart)                    \
  X(Awls)                          \
  X(AwlsBlock)                     \
  X(AwlsAccelerated)               \
  X(AwlsGss)                       \
  X(AwlsLiteral)                   \
  X(Hybrid)                        \
  X(Newton)                        \
  X(Varpro)                        \
  X(Lm)                            \
  X(LmPlain)

namespace trilobe {

#define TRILOBE_DECLARE(NAME) SolverEntry NAME##Entry();
TRILOBE_FOR_EACH_SOLVER(TRILOBE_DECLARE)
#undef TRILOBE_DECLARE

namespace {

std::vector<SolverEntry>& MutableSolvers() {
  static std::vector<SolverEntry> solvers = {
#define TRILOBE_LIST(NAME) NAME##Entry(),
      TRILOBE_FOR_EACH_SOLVER(TRILOBE_LIST)
#undef TRILOBE_LIST
  };
  return solvers;
}

}  // namespace

const std::vector<SolverEntry>& Solvers() { return MutableSolvers(); }

void RegisterSolver(SolverEntry entry) {
  if (entry.name.empty()) throw Error(ErrorKind::kMissing, "a solver needs a name").About("name");
  if (!entry.make) {
    throw Error(ErrorKind::kMissing, "solver '" + entry.name + "' has no function that makes it")
        .About("make", entry.name);
  }
  for (const std::string& option : entry.options) FindSolverOption(option);
  for (const SolverEntry& known : Solvers()) {
    if (known.name == entry.name) {
      throw Error(ErrorKind::kConflict, "there is a solver named '" + entry.name + "' already")
          .About("solver", entry.name);
    }
  }
  MutableSolvers().push_back(std::move(entry));
}

const SolverEntry& FindSolver(std::string_view name) {
  return FindNamed("solver", name, Solvers());
}

std::unique_ptr<Solver> MakeSolver(std::string_view name) {
  const SolverEntry& entry = FindSolver(name);
  std::unique_ptr<Solver> solver = entry.make();
  if (solver == nullptr) {
    throw Error(ErrorKind::kMissing, "solver '" + std::string(name) + "' was not made")
        .About("solver", name);
  }
  solver->own_options_ = entry.options;
  return solver;
}

}  // namespace trilobe
