#include "solvers/joint/softening.h"

#include "solvers/joint/log_stepper.h"

namespace trilobe {

FactorModel Soften(const Objective& objective, const FactorModel& start,
                   const StiffnessSchedule& schedule, const StopCheck& stop, PhaseSeconds* phases) {
  constexpr int kMaxTries = 12;  // of steps with one lambda
  // A step that lowers E + penalty by less than this fraction is the last of its lambda.
  constexpr double kSmallDecrease = 1e-3;
  LogStepper stepper(objective, phases, schedule.slope);
  stepper.Restart(start);
  for (double lambda = schedule.stiffest; lambda > 0.9 * schedule.softest;
       lambda /= schedule.factor) {
    stepper.set_stiffness(lambda);
    for (int k = 0; k < kMaxTries && !stepper.exhausted() && !stop(); ++k) {
      const double before = stepper.minimised();
      if (stepper.Step() && stepper.minimised() > (1 - kSmallDecrease) * before) break;
    }
  }
  return stepper.current();
}

}  // namespace trilobe
