#ifndef TRILOBE_SOLVERS_JOINT_JOINT_STEP_H_
#define TRILOBE_SOLVERS_JOINT_JOINT_STEP_H_

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "solvers/joint/nonnegative_step.h"
#include "solvers/joint/reduction.h"
#include "solvers/sweep.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {

// Damped Newton or Gauss-Newton steps in all parameters under x >= 0, one trial step at a time.
// lambda follows Nielsen's rule (Damping parameter in Marquardt's method, 1999): it decreases
// smoothly with the gain of an accepted step and increases ever faster while steps are rejected.
// A parameter that the data hardly determine is damped like the others of its table
// (DampingMetric). Use:
//
//   JointStepper stepper(objective, Curvature::kByProgress, Trial::kProjected, &phases);
//   stepper.Restart(model);
//   while (!stepper.exhausted() && !converged) stepper.Step();
class JointStepper {
 public:
  // The Hessian of a step. J'J makes longer steps while E is far from its minimum, but does not see
  // directions of negative curvature. The exact Hessian does, and converges faster near the end.
  enum class Curvature {
    kGaussNewton,
    kNewton,
    kByProgress,  // exact after a step that lowers E by less than 0.1 %, else J'J
  };

  // How a trial point is changed before E decides on it.
  enum class Trial {
    kAsItIs,
    kProjected,  // E is minimised over d, s, D and F block by block, with G held
  };

  // Adds times to *phases. With a reduction, which must outlive the stepper, steps are in its
  // parameters y and `trial` must be kAsItIs.
  JointStepper(const Objective& objective, Curvature curvature, Trial trial, PhaseSeconds* phases,
               const Reduction* reduction = nullptr);

  // Moves to another point and keeps the damping. With a reduction, the point must be B y for some
  // y.
  void Restart(const FactorModel& model);

  // Tries one step. Returns false, and keeps the point, if it did not lower E.
  bool Step();
  // Whether lambda has reached its maximum: no step lowers E.
  bool exhausted() const;
  // Whether lambda was so large that the last step had to be short. A small decrease of E is then
  // no sign of convergence.
  bool held_back() const { return held_back_; }
  // Whether the last step was rejected, not held back, and predicted to lower E by less than its
  // rounding error. Further steps would depend on the processor's last bits.
  bool settled() const { return settled_; }

  const FactorModel& current() const { return current_; }
  double E() const { return E_; }
  // Frees memory until the next step: some hundred megabytes for 2,000 parameters.
  void ReleaseScratch();
  // Diagnosis::optimality of the point. Makes a pass over the data if the point is new.
  double Optimality();

 private:
  void MakeScratch();
  double Evaluate(const FactorModel& model);
  // Rounding error of E: sqrt(number of terms) eps E.
  double RoundingOfE() const;
  void Linearize();
  NonnegativeStep NewStep() const;

  const Objective& objective_;
  const Curvature curvature_;
  const Reduction* const reduction_;
  Hessian hessian_;  // of the next point
  PhaseSeconds* const phases_;
  const Trial trial_;
  // Empty from ReleaseScratch to the next step; sweep_ is null unless trials are projected.
  std::optional<NormalEquations> equations_;
  std::unique_ptr<Sweep> sweep_;
  FactorModel current_;
  double E_ = 0;
  bool linearized_ = false;
  QuadraticModel at_;      // of the current point, if linearized_; in y with a reduction
  std::vector<double> y_;  // parameters of the steps: y of the reduction, or all x
  NonnegativeStep step_;
  std::vector<bool> binding_;
  double lambda_;
  bool held_back_ = false, settled_ = false;
  double growth_ = 2;      // factor of lambda after the next rejection
  double indefinite_ = 0;  // lambda that made the current H positive definite; 0: not needed
};

// Makes up to `steps` steps of curvature kByProgress. Stops earlier if the stepper is exhausted, if
// a step that was not held back lowers E by less than the fraction `small`, or if `stop` returns
// true. Trials are projected unless there is a reduction.
struct SteppedModel {
  FactorModel model;
  double E;
};
SteppedModel JointSteps(const Objective& objective, const FactorModel& start, int steps,
                        const StopCheck& stop, const Reduction* reduction = nullptr,
                        double small = 0);

// The damping metric S: the length of each column of J, but at least 1/10 of the root mean square
// within its part; 0 for zero columns.
std::vector<double> DampingMetric(std::span<const FactorModel::Part> parts,
                                  std::span<const double> squared_lengths);

// Makes and records steps until the run stops. The stepper must be at the run's last point.
void RepeatJointSteps(JointStepper* stepper, Run* run);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_JOINT_STEP_H_
