#include "trilobe/solvers/joint/stretch_search.h"

#include <optional>
#include <utility>

#include "trilobe/solvers/joint/stretch_step.h"

namespace trilobe {

SteppedModel FitStretches(const Objective& objective, const FactorModel& fitted,
                          const std::function<bool()>& stop) {
  constexpr int kJointSteps = 3;  // at each point
  constexpr int kMaxTries = 20;
  constexpr double kMaxStep = 0.4;  // of an exponent
  constexpr double kSmall = 1e-3;   // a decrease of E, relative, that ends the search
  const auto fit_from = [&](const FactorModel& start) {
    return JointSteps(Objective(objective, start.spec()), start, kJointSteps, stop);
  };
  SteppedModel best = fit_from(fitted);
  double lambda = 1e-2;
  std::optional<StretchStepper> stepper;
  for (int tries = 0; tries < kMaxTries && !stop(); ++tries) {
    if (!stepper) stepper.emplace(Objective(objective, best.model.spec()), best.model);
    const std::optional<FactorModel> start = stepper->Step(lambda, kMaxStep);
    if (!start) break;
    SteppedModel trial = fit_from(*start);
    if (trial.E < best.E) {
      const bool small = trial.E > (1 - kSmall) * best.E;
      best = std::move(trial);
      stepper.reset();
      lambda /= 4;
      if (small) break;
    } else {
      lambda *= 8;
    }
  }
  return best;
}

}  // namespace trilobe
