#ifndef TRILOBE_SOLVERS_SMOOTH_SOFTENING_H_
#define TRILOBE_SOLVERS_SMOOTH_SOFTENING_H_

#include "trilobe/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// Continuation: a fit with tables so stiff that E has few minima, which then soften,
//   lambda = `stiffest`, stiffest / sqrt(10), stiffest / 10, ... 1e-9,
// each from where the one before ended. What is settled while tables are stiff, which lobe is what,
// stays so. Returns where it leads from `start`, or has led when asked to `stop`. Times go to
// *phases.
inline constexpr double kStiffTables = 1e-4;
FactorModel Soften(const Objective& objective, const FactorModel& start, double stiffest,
                   const StopCheck& stop, PhaseSeconds* phases);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SMOOTH_SOFTENING_H_
