#include "trilobe/solvers/joint_step.h"

#include <algorithm>
#include <utility>

#include "trilobe/solvers/diagnosis.h"
#include "trilobe/solvers/run.h"

namespace trilobe {
namespace {

constexpr double kInitialLambda = 1e-3;  // against columns of J of length 1
constexpr double kMinLambda = 1e-12, kMaxLambda = 1e16;
constexpr double kMinGain = 1e-4;
constexpr double kMaxFall = 1.0 / 8;  // of lambda after one step
// Where H is indefinite, the least lambda that mends it is searched for by this factor.
constexpr double kIndefiniteGrowth = 4, kMinIndefiniteLambda = 1e-4;

}  // namespace

JointStepper::JointStepper(const Objective& objective, PhaseSeconds* phases)
    : objective_(objective), phases_(phases), equations_(objective), lambda_(kInitialLambda) {}

void JointStepper::Restart(const FactorModel& model) {
  current_ = model;
  const ScopedTimer timer(&phases_->evaluating);
  E_ = objective_.Value(current_);
  linearized_ = false;
  growth_ = 2;
}

void JointStepper::Linearize() {
  if (linearized_) return;
  {
    const ScopedTimer timer(&phases_->evaluating);
    equations_.Evaluate(current_, Hessian::kNewton, &at_);
  }
  const ScopedTimer timer(&phases_->linear_algebra);
  step_.MoveTo(at_, current_.parameters());
  if (!binding_.empty()) step_.SetBinding(binding_);
  linearized_ = true;
}

bool JointStepper::Step() {
  Linearize();
  FactorModel trial = current_;
  NonnegativeStep::Result result;
  {
    const ScopedTimer timer(&phases_->linear_algebra);
    result = step_.Solve(lambda_);
    while (!(result.predicted_decrease > 0) && !exhausted()) {  // H + lambda S^2 is not positive
      indefinite_ = lambda_ = std::max(kIndefiniteGrowth * lambda_, kMinIndefiniteLambda);
      result = step_.Solve(lambda_);
    }
  }
  std::ranges::copy(result.x, trial.parameters().begin());
  double E = 0;
  {
    const ScopedTimer timer(&phases_->evaluating);
    E = objective_.Value(trial);
  }
  const double gain = (E_ - E) / (2 * result.predicted_decrease);
  if (!(E < E_ && gain > kMinGain)) {
    lambda_ *= growth_;
    growth_ *= 2;
    return false;
  }
  const double f = 2 * gain - 1;
  // Not at once to where the last H was indefinite: the next one is much like it.
  lambda_ = std::max(
      {kMinLambda, indefinite_ / kIndefiniteGrowth, lambda_ * std::max(kMaxFall, 1 - f * f * f)});
  indefinite_ = 0;
  growth_ = 2;
  current_ = std::move(trial);
  E_ = E;
  binding_ = step_.binding();
  linearized_ = false;
  return true;
}

bool JointStepper::exhausted() const { return !(lambda_ < kMaxLambda); }

double JointStepper::Optimality() {
  Linearize();
  return ScaledProjectedGradient(at_, current_.parameters());
}

void RepeatNewtonSteps(JointStepper* stepper, Run* run) {
  for (bool go_on = !run->stopped(); go_on;) {
    Run::Step step{.accepted = stepper->Step()};
    if (stepper->exhausted()) run->Stop(StopReason::kNoDecrease);
    if (step.accepted) step.optimality = stepper->Optimality();
    step.objective = stepper->E();
    go_on = run->Record(stepper->current(), step);
  }
}

}  // namespace trilobe
