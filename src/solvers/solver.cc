#include "trilobe/solvers/solver.h"

#include "trilobe/core/base/check.h"

namespace trilobe {

bool HasEnded(StopReason reason) {
  return reason != StopReason::kMaxIterations && reason != StopReason::kMaxSeconds &&
         reason != StopReason::kInterrupted;
}

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

SolverSummary Solver::Solve(const Objective& objective, const SolverOptions& options,
                            FactorModel* model) const {
  CheckSameSpec(NotNull(model, "the model to start from").spec(), objective.spec());
  CheckParameters(*model);
  CheckSolverOptions(options);
  if (options.g_filter_sigma > 0) CheckIsotropic(objective.spec(), "the Gaussian filter on G");
  SolverSummary summary = DoSolve(objective, options, model);
  summary.own_options = own_options_;
  return summary;
}

}  // namespace trilobe
