#ifndef TRILOBE_SOLVERS_SMOOTH_SMOOTHEST_H_
#define TRILOBE_SOLVERS_SMOOTH_SMOOTHEST_H_

#include <optional>

#include "trilobe/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/objective/objective.h"

namespace trilobe {

struct SmoothedModel {
  FactorModel model;
  double rise = 0;       // of E, as a fraction
  double stiffness = 0;  // lambda that leads there
};

// Of all models whose E is at most (1 + share) times that of `model`, about the smoothest
// (Roughness) that steps from there lead to: E + lambda E0 R is lowered, lambda such that E rises
// by as much, and light is held where it is. Along flat valleys of E, where data do not choose,
// smoothness does. Nothing where no smoother model was found, and where E
// is 0.
std::optional<SmoothedModel> Smoothest(const Objective& objective, const FactorModel& model,
                                       double share, const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SMOOTH_SMOOTHEST_H_
