#ifndef TRILOBE_FIT_FINISH_STRETCH_SEARCH_H_
#define TRILOBE_FIT_FINISH_STRETCH_SEARCH_H_

#include "solvers/joint/joint_step.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// A model whose lobes are stretched, in whole hundredths, as steps of all exponents and parameters
// (StretchStepper, JointSteps) lead to from `fitted`, an isotropic one, and E there. For few
// samples, of which an objective is made anew at every step; its own spec does not matter. Lobes
// that share D have one stretch together. Once `stop` is true the best so far is returned. The same
// bits for any number of threads, as long as it stays false.
SteppedModel FitStretches(const Objective& objective, const FactorModel& fitted,
                          const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_STRETCH_SEARCH_H_
