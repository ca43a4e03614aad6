#include "trilobe/solvers/solver.h"

#include <utility>

#include "trilobe/base/error.h"
#include "trilobe/base/named.h"

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

const char* StopReasonName(StopReason reason) {
  switch (reason) {
    case StopReason::kConverged:
      return "converged";
    case StopReason::kOptimal:
      return "optimal";
    case StopReason::kExactFit:
      return "exact_fit";
    case StopReason::kNoDecrease:
      return "no_decrease";
    case StopReason::kMaxIterations:
      return "max_iterations";
    case StopReason::kMaxSeconds:
      return "max_seconds";
    case StopReason::kInterrupted:
      return "interrupted";
  }
  return "";
}

const char* PositivityName(Positivity positivity) {
  switch (positivity) {
    case Positivity::kActiveSet:
      return "active_set";
    case Positivity::kBounds:
      return "bounds";
    case Positivity::kSquares:
      return "squares";
  }
  return "";
}

const char* TrustRegionName(TrustRegion trust_region) {
  return trust_region == TrustRegion::kDogleg ? "dogleg" : "levenberg_marquardt";
}

const std::vector<SolverEntry>& Solvers() { return MutableSolvers(); }

void RegisterSolver(SolverEntry entry) {
  for (const SolverEntry& known : Solvers()) {
    if (known.name == entry.name) {
      throw Error("there is a solver named '" + entry.name + "' already");
    }
  }
  MutableSolvers().push_back(std::move(entry));
}

const SolverEntry& FindSolver(std::string_view name) {
  return FindNamed("solver", name, Solvers());
}

std::unique_ptr<Solver> MakeSolver(std::string_view name) { return FindSolver(name).make(); }

}  // namespace trilobe
