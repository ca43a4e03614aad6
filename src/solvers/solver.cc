#include "trilobe/solvers/solver.h"

#include <sstream>

#include "trilobe/base/named.h"
#include "trilobe/solvers/awls.h"
#include "trilobe/solvers/awls_literal.h"

namespace trilobe {

const char* StopReasonName(StopReason reason) {
  switch (reason) {
    case StopReason::kConverged:
      return "converged";
    case StopReason::kExactFit:
      return "exact_fit";
    case StopReason::kMaxIterations:
      return "max_iterations";
    case StopReason::kMaxSeconds:
      return "max_seconds";
    case StopReason::kInterrupted:
      return "interrupted";
  }
  return "";
}

std::string SolverSummary::BriefReport() const {
  std::ostringstream out;
  out << solver << ": " << iterations << " iterations in " << seconds << " s, E from "
      << initial_objective << " to " << final_objective << ", stopped by "
      << StopReasonName(stop_reason);
  return out.str();
}

const std::vector<SolverEntry>& Solvers() {
  static const std::vector<SolverEntry> solvers = {
      {"awls", "alternating weighted least squares from exact sums (docs/method.md)",
       [] { return std::make_unique<Awls>(); }},
      {"awls_literal", "the same, element by element over the samples (Peng et al. 2.3): slow",
       [] { return std::make_unique<AwlsLiteral>(); }},
  };
  return solvers;
}

std::unique_ptr<Solver> MakeSolver(std::string_view name) {
  return FindNamed("solver", name, Solvers()).make();
}

}  // namespace trilobe
