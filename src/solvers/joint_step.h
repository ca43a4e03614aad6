#ifndef TRILOBE_SOLVERS_JOINT_STEP_H_
#define TRILOBE_SOLVERS_JOINT_STEP_H_

#include <vector>

#include "trilobe/solvers/nonnegative_step.h"
#include "trilobe/solvers/normal_equations.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// Damped Newton iterations on all parameters at once, under x >= 0, one trial step at a time. The
// Hessian is all of it: residuals are not small here, and where two factors of a lobe are both free
// to grow, J'J alone predicts a step's gain badly. Damping as in Levenberg-Marquardt, by Nielsen's
// rule (Damping parameter in Marquardt's method, 1999): lambda falls smoothly with the gain of an
// accepted step, and rises ever faster while steps are rejected.
class JointStepper {
 public:
  // Times go to *phases.
  JointStepper(const Objective& objective, PhaseSeconds* phases);

  // Goes on from another point, with the same damping.
  void Restart(const FactorModel& model);

  // Tries one step; false if it did not lower E, so that the point stayed where it was.
  bool Step();
  // No damping leads to a lower E.
  bool exhausted() const;

  const FactorModel& current() const { return current_; }
  double E() const { return E_; }
  // Diagnosis::optimality of the point. Passes over the data when the point is new.
  double Optimality();

 private:
  void Linearize();

  const Objective& objective_;
  PhaseSeconds* const phases_;
  NormalEquations equations_;
  FactorModel current_;
  double E_ = 0;
  bool linearized_ = false;
  QuadraticModel at_;  // of the current point, if linearized_
  NonnegativeStep step_;
  std::vector<bool> binding_;
  double lambda_;
  double growth_ = 2;      // of lambda when the next step is rejected
  double indefinite_ = 0;  // the lambda that the current H needed to become positive; 0 for none
};

// Makes and records steps of the stepper, which stands at the run's last point, until the run
// stops.
void RepeatNewtonSteps(JointStepper* stepper, Run* run);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_STEP_H_
