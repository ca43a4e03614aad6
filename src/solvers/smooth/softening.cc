#include "solvers/smooth/softening.h"

#include <cmath>

#include "solvers/smooth/log_stepper.h"

namespace trilobe {

FactorModel Soften(const Objective& objective, const FactorModel& start, double stiffest,
                   const StopCheck& stop, PhaseSeconds* phases) {
  constexpr double kSoftest = 1e-9;
  constexpr int kMaxTries = 12;  // of steps with one lambda
  // A step that lowers E + penalty by less than this fraction is the last of its lambda.
  constexpr double kSmallDecrease = 1e-3;
  LogStepper stepper(objective, phases);
  stepper.Restart(start);
  for (double lambda = stiffest; lambda > 0.9 * kSoftest; lambda /= std::sqrt(10.0)) {
    stepper.set_stiffness(lambda);
    for (int k = 0; k < kMaxTries && !stepper.exhausted() && !stop(); ++k) {
      const double before = stepper.minimised();
      if (stepper.Step() && stepper.minimised() > (1 - kSmallDecrease) * before) break;
    }
  }
  return stepper.current();
}

}  // namespace trilobe
