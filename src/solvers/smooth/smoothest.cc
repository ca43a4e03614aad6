#include "solvers/smooth/smoothest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/smooth/log_stepper.h"

namespace trilobe {

std::optional<SmoothedModel> Smoothest(const Objective& objective, const FactorModel& model,
                                       double share, const StopCheck& stop) {
  constexpr double kFirstStiffness = 1e-7, kMaxChange = 10;
  constexpr int kMaxSteps = 40, kStepsWithOne = 3;
  constexpr double kSmallDecrease = 1e-4, kLeastOfShare = 0.7, kAim = 0.85;
  constexpr double kPriceOfLight = 30;  // an error of 1 % costs 0.3 % of E
  const double E = objective.Value(model), allowed = share * E;
  if (!(allowed > 0)) return std::nullopt;
  PhaseSeconds phases;
  const ReflectancePrice price(objective, model, kPriceOfLight * E);
  LogStepper stepper(objective, &phases);
  stepper.set_price(&price);
  stepper.Restart(model);
  std::optional<SmoothedModel> smoothest;
  double least = std::numeric_limits<double>::infinity();
  double stiffness = kFirstStiffness;
  stepper.set_stiffness(stiffness);
  for (int k = 0, with_this = 0; k < kMaxSteps && !stepper.exhausted() && !stop(); ++k) {
    const double before = stepper.minimised();
    if (!stepper.Step()) continue;
    const double rise = stepper.E() - E;
    if (rise <= allowed && stepper.roughness() < least) {
      least = stepper.roughness();
      smoothest = {.model = stepper.current(), .rise = rise / E, .stiffness = stiffness};
    }
    const bool little = stepper.minimised() > (1 - kSmallDecrease) * before;
    if (!little && ++with_this < kStepsWithOne) continue;
    if (rise >= kLeastOfShare * allowed && rise <= allowed) break;
    // As if the rise were in proportion to lambda, which it is at most.
    const double change = kAim * allowed / std::max(rise, allowed / kMaxChange);
    stiffness *= std::max(change, 1 / kMaxChange);
    stepper.set_stiffness(stiffness);
    with_this = 0;
  }
  return smoothest;
}

}  // namespace trilobe
