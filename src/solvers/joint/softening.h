#ifndef TRILOBE_SOLVERS_JOINT_SOFTENING_H_
#define TRILOBE_SOLVERS_JOINT_SOFTENING_H_

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
  double slope = 0;  // of Roughness
};

// Continuation: first fits with tables so stiff that E has few minima, then lowers lambda, each fit
// from the result of the one before. The roles of lobes settle while tables are stiff. Returns the
// model reached from `start`, at the end or when stopped. Adds times to *phases.
FactorModel Soften(const Objective& objective, const FactorModel& start,
                   const StiffnessSchedule& schedule, const StopCheck& stop, PhaseSeconds* phases);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_SOFTENING_H_
