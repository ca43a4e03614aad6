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
  double stiffness = 0;  // lambda that leads there
};

// Of all models whose E is at most (1 + share) times that of `model`, or of the least E that is met
// on the way, about the smoothest (Roughness, with a small price of a steady fall, which two tables
// may otherwise exchange) that steps from there lead to: E + lambda E0 R is lowered with a lambda
// that grows until E rises by as much, and light is held where it is. Along flat valleys of E,
// where data do not choose, smoothness does. Of the models on that way, in canonical form, the
// smoothest that is `acceptable`; nothing where none is, and where E is 0.
std::optional<SmoothedModel> Smoothest(const Objective& objective, const FactorModel& model,
                                       double share,
                                       const std::function<bool(const FactorModel&)>& acceptable,
                                       const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_SMOOTHEST_H_
