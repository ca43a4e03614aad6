#include "fit/finish/stretch_search.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "fit/finish/stretch_step.h"
#include "trilobe/core/base/stop_check.h"

namespace trilobe {

SteppedModel FitStretches(const Objective& objective, const FactorModel& fitted,
                          const StopCheck& stop) {
  constexpr int kJointSteps = 3;  // at each point
  constexpr int kMaxTries = 32;
  constexpr int kMaxRejected = 5;   // in a row
  constexpr double kMaxStep = 0.4;  // of an exponent
  constexpr double kMinLambda = 1e-4;
  constexpr double kSmall = 3e-3;  // a decrease of E, relative, that ends the search
  // Where the samples are prepared for the stretches of the best point, steps from it are, too.
  Objective at_best(objective, fitted.spec());
  SteppedModel best = JointSteps(at_best, fitted, kJointSteps, stop);
  double lambda = 1e-2;
  double follow = 1;  // how far the parameters follow a step
  int rejected = 0;
  std::optional<StretchStepper> stepper;
  for (int tries = 0; tries < kMaxTries && rejected < kMaxRejected && !stop(); ++tries) {
    if (!stepper) stepper.emplace(at_best, best.model);
    const std::optional<FactorModel> start = stepper->Step(lambda, kMaxStep, follow);
    if (!start) break;
    Objective at_trial(objective, start->spec());
    SteppedModel trial = JointSteps(at_trial, *start, kJointSteps, stop);
    if (trial.E < best.E) {
      const bool small = trial.E > (1 - kSmall) * best.E;
      best = std::move(trial);
      at_best = std::move(at_trial);
      stepper.reset();
      lambda = std::max(lambda / 4, kMinLambda);
      follow = std::min(2 * follow + 0.125, 1.0);
      rejected = 0;
      if (small) break;
    } else {
      // From where they are, joint steps lower E in any case once the exponents hardly move.
      if (follow == 0) lambda *= 8;
      follow = 0;
      ++rejected;
    }
  }
  return best;
}

}  // namespace trilobe
