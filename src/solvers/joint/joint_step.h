#ifndef TRILOBE_SOLVERS_JOINT_JOINT_STEP_H_
#define TRILOBE_SOLVERS_JOINT_JOINT_STEP_H_

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "solvers/awls/sweep.h"
#include "solvers/joint/nonnegative_step.h"
#include "solvers/joint/reduction.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {

// Damped Newton or Gauss-Newton iterations on all parameters at once, under x >= 0, one trial step
// at a time. Damping as in Levenberg-Marquardt, by Nielsen's rule (Damping parameter in Marquardt's
// method, 1999): lambda falls smoothly with the gain of an accepted step, and rises ever faster
// while steps are rejected. A parameter that the data hardly see is damped like its table's others
// (docs/solvers.md): on its own it could go anywhere, and where its partners in the product
// are small it would go far, and spoil the product once they grow.
class JointStepper {
 public:
  // Which Hessian: J'J makes the longer steps as long as there is much to gain, but is blind to
  // directions in which E curves down; all of it finds those, and is right near the end.
  enum class Curvature {
    kGaussNewton,
    kNewton,
    kByProgress,  // J'J until a step lowers E little; again after one that lowered it much
  };

  // What becomes of a trial point before it is judged.
  enum class Trial {
    kAsItIs,
    kProjected,  // d, s, D and F are put where E is lowest, block by block, given G and the others
  };

  // Times go to *phases. With a reduction, which must outlive the stepper, the steps are of its
  // parameters y; trials cannot be projected then.
  JointStepper(const Objective& objective, Curvature curvature, Trial trial, PhaseSeconds* phases,
               const Reduction* reduction = nullptr);

  // Goes on from another point, with the same damping. With a reduction the point must be one of
  // its own.
  void Restart(const FactorModel& model);

  // Tries one step; false if it did not lower E, so that the point stayed where it was.
  bool Step();
  // No damping leads to a lower E.
  bool exhausted() const;
  // Damping, not the shape of E, made the last step short: that it lowered E little says nothing
  // about how much there is to gain.
  bool held_back() const { return held_back_; }
  // The last step was taken back, damping had not made it short, and it would have lowered E by
  // less than E is rounded by: whether another one lowers E is up to its last bits, which differ
  // between processors.
  bool settled() const { return settled_; }

  const FactorModel& current() const { return current_; }
  double E() const { return E_; }
  // Gives back what it can make again, some hundred megabytes for a model of 2,000 parameters,
  // until the next step.
  void ReleaseScratch();
  // Diagnosis::optimality of the point. Passes over the data when the point is new.
  double Optimality();

 private:
  void MakeScratch();
  double Evaluate(const FactorModel& model);
  // What the sum of so many terms may be off by, if each rounds either way.
  double RoundingOfE() const;
  void Linearize();
  NonnegativeStep NewStep() const;

  const Objective& objective_;
  const Curvature curvature_;
  const Reduction* const reduction_;
  Hessian hessian_;  // of the next point
  PhaseSeconds* const phases_;
  const Trial trial_;
  // None from ReleaseScratch to the next step; a sweep only if trials are projected.
  std::optional<NormalEquations> equations_;
  std::unique_ptr<Sweep> sweep_;
  FactorModel current_;
  double E_ = 0;
  bool linearized_ = false;
  QuadraticModel at_;      // of the current point, if linearized_; in y with a reduction
  std::vector<double> y_;  // what steps move: the reduction's parameters, or all
  NonnegativeStep step_;
  std::vector<bool> binding_;
  double lambda_;
  bool held_back_ = false, settled_ = false;
  double growth_ = 2;      // of lambda when the next step is rejected
  double indefinite_ = 0;  // the lambda that the current H needed to become positive; 0 for none
};

// The point after so many steps of curvature kByProgress from this one, and E there; after fewer
// where no damping leads lower, after a step that lowers E by less than the fraction `small` of it
// though damping did not hold it back, and once `stop` is true. Trials are projected, unless there
// is a reduction.
struct SteppedModel {
  FactorModel model;
  double E;
};
SteppedModel JointSteps(const Objective& objective, const FactorModel& start, int steps,
                        const StopCheck& stop, const Reduction* reduction = nullptr,
                        double small = 0);

// The metric S of the damping of steps in parameters that make up these parts, from the squared
// lengths of the columns of J. 0 where that is 0.
std::vector<double> DampingMetric(std::span<const FactorModel::Part> parts,
                                  std::span<const double> squared_lengths);

// Makes and records steps of the stepper, which stands at the run's last point, until the run
// stops.
void RepeatJointSteps(JointStepper* stepper, Run* run);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_JOINT_STEP_H_
