#ifndef TRILOBE_FIT_FINISH_SMOOTHEST_H_
#define TRILOBE_FIT_FINISH_SMOOTHEST_H_

#include <functional>
#include <optional>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

struct SmoothedModel {
  FactorModel model;
  double rise = 0;       // of E, as a fraction
  double stiffness = 0;  // lambda that gives this model
};

// About the smoothest model whose E is at most (1 + share) times that of `model`, or of the least E
// met on the way. Smoothness decides along flat valleys of E, where the data do not. Steps minimise
// E + lambda E0 R, R = Roughness with a small slope term, and hold the reflectance; lambda grows
// until E has risen by the share. Returns the smoothest model of this path, in canonical form, that
// is `acceptable`; nothing if there is none or E is 0.
std::optional<SmoothedModel> Smoothest(const Objective& objective, const FactorModel& model,
                                       double share,
                                       const std::function<bool(const FactorModel&)>& acceptable,
                                       const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_SMOOTHEST_H_
