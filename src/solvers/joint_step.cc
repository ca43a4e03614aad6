#include "trilobe/solvers/joint_step.h"

#include <algorithm>

#include "trilobe/solvers/diagnosis.h"
#include "trilobe/solvers/run.h"

namespace trilobe {
namespace {

constexpr double kInitialLambda = 1e-3;  // against columns of J of length 1
constexpr double kMinLambda = 1e-12, kMaxLambda = 1e16;
constexpr double kMinGain = 1e-4;

}  // namespace

JointStepper::JointStepper(const Objective& objective, PhaseSeconds* phases)
    : objective_(objective),
      phases_(phases),
      equations_(objective),
      lambda_(kInitialLambda),
      growth_(2) {}

void JointStepper::Restart(const FactorModel& model) {
  current_ = model;
  const ScopedTimer timer(&phases_->evaluating);
  E_ = objective_.Value(current_);
  step_.reset();
  growth_ = 2;
}

void JointStepper::Linearize() {
  if (step_) return;
  {
    const ScopedTimer timer(&phases_->evaluating);
    equations_.Evaluate(current_, hessian_, &at_);
  }
  const ScopedTimer timer(&phases_->linear_algebra);
  step_.emplace(at_, current_.parameters());
  if (!binding_.empty()) step_->SetBinding(binding_);
}

bool JointStepper::Step() {
  Linearize();
  FactorModel trial = current_;
  NonnegativeStep::Result result;
  {
    const ScopedTimer timer(&phases_->linear_algebra);
    result = step_->Solve(lambda_);
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
  lambda_ = std::max(kMinLambda, lambda_ * std::max(1.0 / 5, 1 - f * f * f));
  growth_ = 2;
  current_ = std::move(trial);
  E_ = E;
  binding_ = step_->binding();
  step_.reset();
  return true;
}

bool JointStepper::exhausted() const { return !(lambda_ < kMaxLambda); }

double JointStepper::Optimality() {
  Linearize();
  return ScaledProjectedGradient(at_, current_.parameters());
}

}  // namespace trilobe
