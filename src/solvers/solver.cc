#include "trilobe/solvers/solver.h"

#include <utility>

#include "trilobe/base/check.h"
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

const std::vector<SolverEntry>& Solvers() { return MutableSolvers(); }

SolverSummary Solver::Solve(const Objective& objective, const SolverOptions& options,
                            FactorModel* model) const {
  CheckSameSpec(NotNull(model, "the model to start from").spec(), objective.spec());
  CheckParameters(*model);
  CheckSolverOptions(options);
  if (options.g_filter_sigma > 0) CheckIsotropic(objective.spec(), "the Gaussian filter on G");
  return DoSolve(objective, options, model);
}

void RegisterSolver(SolverEntry entry) {
  if (entry.name.empty()) throw Error("a solver needs a name");
  if (!entry.make) throw Error("solver '" + entry.name + "' has no function that makes it");
  for (const std::string& option : entry.options) FindSolverOption(option);
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

std::unique_ptr<Solver> MakeSolver(std::string_view name) {
  std::unique_ptr<Solver> solver = FindSolver(name).make();
  if (solver == nullptr) throw Error("solver '" + std::string(name) + "' was not made");
  return solver;
}

}  // namespace trilobe
