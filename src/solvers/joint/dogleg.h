#ifndef TRILOBE_SOLVERS_JOINT_DOGLEG_H_
#define TRILOBE_SOLVERS_JOINT_DOGLEG_H_

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// The model after at most so many dogleg steps of `lm`, which are longer than others and so lead to
// other minima. Adds times to *phases.
FactorModel AfterDoglegSteps(const Objective& objective, FactorModel model, int steps,
                             const StopCheck& stop, PhaseSeconds* phases);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_DOGLEG_H_
