#include "solvers/joint/joint_step.h"

#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/diagnosis.h"
#include "solvers/sweep.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/solvers/run.h"

namespace trilobe {
namespace {

constexpr double kInitialLambda = 1e-2;  // against columns of J of length 1
constexpr double kMinLambda = 1e-12, kMaxLambda = 1e16;
// Along one column of J, a step under this damping lowers E by less than the fraction 2 / lambda,
// however much there is to gain.
constexpr double kHeavyLambda = 1e3;
constexpr double kMinGain = 1e-4;
constexpr double kMaxFall = 1.0 / 3;  // of lambda after one step
// Growth of lambda per try while H + lambda S^2 is indefinite, and the least lambda then.
constexpr double kIndefiniteGrowth = 4, kMinIndefiniteLambda = 1e-4;
// Relative decrease of E below which progress counts as slow.
constexpr double kLittleProgress = 1e-3;
// Least squared length of a column of J in the damping, relative to the mean square of its table's
// columns.
constexpr double kMinSquaredLength = 1e-2;

// Elimination order of anisotropic models: D of all lobes first, azimuth by azimuth. An entry of D
// has products with those of D that some sample reads together with it, its neighbours, and with
// all of F, G and the amplitudes.
std::vector<size_t> OrderByAzimuth(const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  std::vector<size_t> order;
  const int phis = spec.d_axis.phi_nodes, thetas = spec.d_axis.size / phis;
  for (int b = 0; b < phis; ++b) {
    for (int a = 0; a < thetas; ++a) {
      for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
        order.push_back(model.TableOffset(Factor::kD, t) + a * phis + b);
      }
    }
  }
  const size_t D = model.TableOffset(Factor::kD, 0), size = model.parameters().size();
  for (size_t k = D + order.size(); k < size; ++k) order.push_back(k);
  for (size_t k = 0; k < D; ++k) order.push_back(k);
  return order;
}

// Elimination order of models with D by channel: what one channel reads alone, channel after
// channel, then what all read. Parameters of different channels have no products.
std::vector<size_t> OrderByChannel(const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  std::array<std::vector<std::pair<Factor, int>>, kChannels + 1> tables;  // the last: of all
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto [begin, end] = spec.channels(factor, t);
      tables[end - begin == 1 ? begin : kChannels].emplace_back(factor, t);
    }
  }
  std::vector<size_t> order;
  for (int c = 0; c <= kChannels; ++c) {
    if (c < kChannels) {
      for (int a = 0; a <= spec.lobes; ++a) order.push_back(kChannels * a + c);
    }
    for (const auto& [factor, t] : tables[c]) {
      for (int k = 0; k < spec.table_size(factor); ++k) {
        order.push_back(model.TableOffset(factor, t) + k);
      }
    }
  }
  return order;
}

// The order in which parameters are eliminated, where that leaves zeros in the factor; empty: as
// they are stored.
std::vector<size_t> EliminationOrder(const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  if (spec.d_axis.polar()) return OrderByAzimuth(model);
  if (spec.D.per_channel) return OrderByChannel(model);
  return {};
}

}  // namespace

std::vector<double> DampingMetric(std::span<const FactorModel::Part> parts,
                                  std::span<const double> squared_lengths) {
  std::vector<double> S(squared_lengths.size(), 0.0);
  for (const auto [begin, size] : parts) {
    double mean = 0;
    for (int k = begin; k < begin + size; ++k) mean += squared_lengths[k] / size;
    for (int k = begin; k < begin + size; ++k) {
      if (!(squared_lengths[k] > 0)) continue;
      S[k] = std::sqrt(std::max(squared_lengths[k], kMinSquaredLength * mean));
    }
  }
  return S;
}

JointStepper::JointStepper(const Objective& objective, Curvature curvature, Trial trial,
                           PhaseSeconds* phases, const Reduction* reduction)
    : objective_(objective),
      curvature_(curvature),
      reduction_(reduction),
      hessian_(curvature == Curvature::kNewton ? Hessian::kNewton : Hessian::kGaussNewton),
      phases_(phases),
      trial_(trial),
      step_(NewStep()),
      lambda_(kInitialLambda) {
  CHECK(reduction == nullptr || trial == Trial::kAsItIs)
      << "a projection would leave the reduction";
}

void JointStepper::MakeScratch() {
  if (equations_) return;
  equations_.emplace(objective_);
  if (trial_ == Trial::kProjected) sweep_ = MakeSweep(objective_, phases_);
}

void JointStepper::ReleaseScratch() {
  equations_.reset();
  sweep_.reset();
  if (linearized_) binding_ = step_.binding();
  step_ = NewStep();
  at_ = {};
  linearized_ = false;
}

NonnegativeStep JointStepper::NewStep() const {
  std::vector<size_t> order = EliminationOrder(FactorModel(objective_.spec()));
  if (reduction_ != nullptr && !order.empty()) {
    constexpr size_t kNone = -1;
    std::vector<size_t> reduced(order.size(), kNone);
    for (int j = 0; j < reduction_->size(); ++j) reduced[reduction_->source()[j]] = j;
    for (size_t& k : order) k = reduced[k];
    std::erase(order, kNone);
  }
  return NonnegativeStep(objective_.num_threads(), std::move(order));
}

void JointStepper::Restart(const FactorModel& model) {
  current_ = model;
  E_ = Evaluate(current_);
  linearized_ = false;
  growth_ = 2;
  indefinite_ = 0;
}

double JointStepper::Evaluate(const FactorModel& model) {
  const ScopedTimer timer(&phases_->evaluating);
  return objective_.Value(model);
}

void JointStepper::Linearize() {
  if (linearized_) return;
  MakeScratch();
  {
    const ScopedTimer timer(&phases_->evaluating);
    equations_->Evaluate(current_, hessian_, &at_);
  }
  const ScopedTimer timer(&phases_->linear_algebra);
  const std::span<const double> x = current_.parameters();
  if (reduction_ != nullptr) {
    at_ = (*reduction_)(at_);
    y_ = reduction_->Restrict(x);
  } else {
    y_.assign(x.begin(), x.end());
  }
  const std::vector<FactorModel::Part> parts =
      reduction_ != nullptr ? reduction_->parts() : current_.Parts();
  step_.MoveTo(at_, DampingMetric(parts, at_.squared_lengths), y_);
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
  held_back_ = lambda_ > kHeavyLambda;
  std::ranges::copy(reduction_ != nullptr ? reduction_->Expand(result.x) : result.x,
                    trial.parameters().begin());
  double E = Evaluate(trial);
  if (sweep_) {
    sweep_->Project(E, &trial);
    E = Evaluate(trial);
  }
  const double gain = (E_ - E) / (2 * result.predicted_decrease);
  VLOG(2) << "joint step: lambda " << lambda_ << ", E " << E_ << " to " << E << ", gain " << gain;
  settled_ = false;
  if (!(E < E_ && gain > kMinGain)) {
    settled_ = !held_back_ && 2 * result.predicted_decrease < RoundingOfE();
    lambda_ *= growth_;
    growth_ *= 2;
    return false;
  }
  const double f = 2 * gain - 1;
  // Does not return at once to where the last H was indefinite: the next one is much like it.
  lambda_ = std::max(
      {kMinLambda, indefinite_ / kIndefiniteGrowth, lambda_ * std::max(kMaxFall, 1 - f * f * f)});
  indefinite_ = 0;
  growth_ = 2;
  if (curvature_ == Curvature::kByProgress) {
    hessian_ = E > (1 - kLittleProgress) * E_ ? Hessian::kNewton : Hessian::kGaussNewton;
  }
  current_ = std::move(trial);
  E_ = E;
  binding_ = step_.binding();
  linearized_ = false;
  return true;
}

double JointStepper::RoundingOfE() const {
  const double terms = static_cast<double>(kChannels) * objective_.num_samples();
  return std::sqrt(terms) * std::numeric_limits<double>::epsilon() * E_;
}

bool JointStepper::exhausted() const { return !(lambda_ < kMaxLambda); }

double JointStepper::Optimality() {
  Linearize();
  return ScaledProjectedGradient(at_, y_);
}

SteppedModel JointSteps(const Objective& objective, const FactorModel& start, int steps,
                        const StopCheck& stop, const Reduction* reduction, double small) {
  PhaseSeconds phases;
  JointStepper stepper(objective, JointStepper::Curvature::kByProgress,
                       reduction ? JointStepper::Trial::kAsItIs : JointStepper::Trial::kProjected,
                       &phases, reduction);
  stepper.Restart(start);
  for (int k = 0; k < steps && !stepper.exhausted() && !stop(); ++k) {
    const double before = stepper.E();
    if (stepper.Step() && !stepper.held_back() && stepper.E() > (1 - small) * before) break;
  }
  return {stepper.current(), stepper.E()};
}

void RepeatJointSteps(JointStepper* stepper, Run* run) {
  for (bool go_on = !run->stopped(); go_on;) {
    Run::Step step{.accepted = stepper->Step()};
    if (stepper->exhausted()) run->Stop(StopReason::kNoDecrease);
    if (stepper->settled()) run->Stop(StopReason::kOptimal);
    if (step.accepted) step.optimality = stepper->Optimality();
    step.objective = stepper->E();
    step.may_converge = !stepper->held_back();
    go_on = run->Record(stepper->current(), step);
  }
}

}  // namespace trilobe
