#ifndef TRILOBE_SOLVERS_SMOOTH_SOFTENING_H_
#define TRILOBE_SOLVERS_SMOOTH_SOFTENING_H_

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

inline constexpr double kStiffTables = 1e-4;

// lambda = stiffest, stiffest / factor, stiffest / factor^2, ... softest.
struct StiffnessSchedule {
  double stiffest = kStiffTables;
  double factor = 3.1622776601683795;  // sqrt(10)
  double softest = 1e-9;
  double slope = 0;  // the price of a steady fall: Roughness
};

// Continuation: a fit with tables so stiff that E has few minima, which then soften, each lambda
// from where the one before ended. What is settled while tables are stiff, which lobe is what,
// stays so. Returns where it leads from `start`, or has led when asked to `stop`. Times go to
// *phases.
FactorModel Soften(const Objective& objective, const FactorModel& start,
                   const StiffnessSchedule& schedule, const StopCheck& stop, PhaseSeconds* phases);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SMOOTH_SOFTENING_H_
