#include "solvers/joint/log_stepper.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/algebra/symmetric_matrix.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/solvers/run.h"

namespace trilobe {
namespace {

// Position of an entry, in units of the paper's 90 bins. Highlights are equally wide in the root of
// theta_h wherever they end.
double Place(Factor factor, double theta) {
  const double t = theta / (kPi / 2);
  return 90 * (factor == Factor::kD ? std::sqrt(t) : t);
}

constexpr double kInitialDamping = 1e-3;  // against the diagonal of H
constexpr double kMinDamping = 1e-7, kMaxDamping = 1e8;
constexpr double kMaxDampingFall = 1.0 / 3;  // of the damping after one step
constexpr double kMinGainRatio = 1e-4;
// No parameter changes by more than a factor of e^1.5 in one step.
constexpr double kMaxMove = 1.5;
// Parameters below kFloor times the largest of their kind are lifted as zeros are; a lift moves the
// residuals by at most kHarmless of their length.
constexpr double kFloor = 1e-6, kHarmless = 1e-2;

}  // namespace

Roughness::Roughness(const ModelSpec& spec, std::span<const double> coverage, double slope)
    : slope_(slope) {
  const FactorModel model(spec);
  std::vector<int> line;
  std::vector<double> places;
  for (const Factor factor : kFactors) {
    const Axis& axis = spec.axis(factor);
    const int phis = axis.phi_nodes, thetas = axis.size / phis;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const int offset = model.TableOffset(factor, t);
      const auto add = [&](int entry, double place) {
        if (!(coverage[offset + entry] > 0)) return;
        line.push_back(offset + entry);
        places.push_back(place);
      };
      for (int b = 0; b < phis; ++b) {
        line.clear();
        places.clear();
        for (int a = 0; a < thetas; ++a) {
          add(a * phis + b, Place(factor, axis.Theta(a * phis + b)));
        }
        AddLine(line, places, 0, 1.0 / phis);
      }
      if (phis < 3) continue;
      for (int a = 0; a < thetas; ++a) {
        line.clear();
        places.clear();
        for (int b = 0; b < phis; ++b) add(a * phis + b, RadiansToDegrees(axis.Phi(a * phis + b)));
        AddLine(line, places, 360, 1.0 / thetas);
      }
    }
  }
}

void Roughness::AddLine(std::span<const int> parameters, std::span<const double> places,
                        double period, double share) {
  const int n = static_cast<int>(parameters.size());
  if (n < 3) return;
  const bool closed = period > 0;
  for (int k = 0; slope_ > 0 && k < (closed ? n : n - 1); ++k) {
    const int after = (k + 1) % n;
    const double h = places[after] - places[k] + (after == 0 ? period : 0);
    const double weight = std::sqrt(slope_ * share / h);
    differences_.push_back(
        {{parameters[k], parameters[after], parameters[k]}, {-weight, weight, 0}});
  }
  for (int k = closed ? 0 : 1; k < (closed ? n : n - 1); ++k) {
    const int before = (k + n - 1) % n, after = (k + 1) % n;
    const double h1 = places[k] - places[before] + (k == 0 ? period : 0);
    const double h2 = places[after] - places[k] + (k == n - 1 ? period : 0);
    const double width = (h1 + h2) / 2, root = std::sqrt(share * width);
    const double w1 = root / (h1 * width), w2 = root / (h2 * width);
    differences_.push_back(
        {{parameters[before], parameters[k], parameters[after]}, {w1, -(w1 + w2), w2}});
  }
}

double Roughness::operator()(std::span<const double> log_parameters) const {
  double sum = 0;
  for (const Difference& difference : differences_) {
    const double value = difference(log_parameters);
    sum += value * value;
  }
  return sum;
}

void Roughness::AddTo(double factor, std::span<const double> log_parameters,
                      QuadraticModel* at) const {
  const size_t n = at->gradient.size();
  at->objective += factor * (*this)(log_parameters);
  for (const Difference& difference : differences_) {
    const double value = factor * difference(log_parameters);
    for (int a = 0; a < 3; ++a) {
      const int k = difference.parameter[a];
      at->gradient[k] += difference.weight[a] * value;
      for (int b = 0; b < 3; ++b) {
        at->H[k * n + difference.parameter[b]] +=
            factor * difference.weight[a] * difference.weight[b];
      }
    }
  }
}

std::optional<std::vector<double>> Roughness::Interpolated(
    std::span<const int> parameters, std::span<const double> log_parameters) const {
  std::vector<int> place(log_parameters.size(), -1);
  const size_t n = parameters.size();
  for (size_t k = 0; k < n; ++k) place[parameters[k]] = static_cast<int>(k);
  std::vector<double> H(n * n, 0.0), change(n, 0.0);
  for (const Difference& difference : differences_) {
    const double value = difference(log_parameters);
    for (int a = 0; a < 3; ++a) {
      const int k = place[difference.parameter[a]];
      if (k < 0) continue;
      change[k] -= difference.weight[a] * value;
      for (int b = 0; b < 3; ++b) {
        const int l = place[difference.parameter[b]];
        if (l >= 0) H[k * n + l] += difference.weight[a] * difference.weight[b];
      }
    }
  }
  const int size = static_cast<int>(n);
  if (!FactorCholesky(size, H.data(), 1)) return std::nullopt;
  SolveLower(size, H.data(), 1, change.data());
  SolveLowerTransposed(size, H.data(), change.data());
  for (size_t k = 0; k < n; ++k) change[k] += log_parameters[parameters[k]];
  return change;
}

LogStepper::LogStepper(const Objective& objective, PhaseSeconds* phases, double slope)
    : objective_(objective),
      phases_(phases),
      equations_(objective),
      roughness_(objective.spec(), objective.coverage(), slope),
      energy_(objective.MeasuredEnergy()),
      current_(objective.spec()),
      damping_(kInitialDamping) {}

void LogStepper::Restart(const FactorModel& model) {
  current_ = model;
  LiftZeros();
  const std::span<double> x = current_.parameters();
  const std::vector<double>& coverage = objective_.coverage();
  moves_.assign(x.size(), false);
  for (size_t k = 0; k < x.size(); ++k) {
    moves_[k] = coverage[k] > 0 && x[k] > 0;
  }
  y_ = Logarithms(current_);
  const ScopedTimer timer(&phases_->evaluating);
  E_ = objective_.Value(current_);
  added_ = AddedAt(current_);
  roughness_value_ = roughness_(y_);
  linearized_ = false;
  damping_ = kInitialDamping;
  growth_ = 2;
}

void LogStepper::LiftZeros() {
  const std::span<double> x = current_.parameters();
  const std::vector<double>& coverage = objective_.coverage();
  std::vector<int> low;
  std::vector<double> y(x.size(), 0.0), least;
  for (const auto [begin, size] : current_.Parts()) {
    const double floor = kFloor * std::ranges::max(x.subspan(begin, size));
    for (int k = begin; k < begin + size; ++k) {
      if (!(coverage[k] > 0) || !(floor > 0)) continue;
      y[k] = std::log(std::max(x[k], floor));
      if (x[k] >= floor) continue;
      low.push_back(k);
      least.push_back(floor);
    }
  }
  if (low.empty()) return;
  {
    const ScopedTimer timer(&phases_->evaluating);
    equations_.Evaluate(current_, Hessian::kGaussNewton, &at_);
  }
  const std::optional<std::vector<double>> smooth = roughness_.Interpolated(low, y);
  for (size_t j = 0; j < low.size(); ++j) {
    const int k = low[j];
    const double wanted = smooth ? std::exp((*smooth)[j]) : least[j];
    const double length = at_.squared_lengths[k];
    const double harmless = length > 0 ? kHarmless * std::sqrt(at_.objective / length) : least[j];
    x[k] = std::max(x[k], std::min(wanted, harmless));
  }
}

double LogStepper::AddedAt(const FactorModel& model) const {
  return added_term_ != nullptr ? (*added_term_)(model) : 0;
}

std::vector<double> LogStepper::Logarithms(const FactorModel& model) const {
  const std::span<const double> x = model.parameters();
  std::vector<double> y(x.size(), 0.0);
  // Roughness asks for no d or s.
  for (size_t k = model.TableOffset(Factor::kD, 0); k < x.size(); ++k) {
    if (moves_[k]) y[k] = std::log(x[k]);
  }
  return y;
}

void LogStepper::set_stiffness(double lambda) {
  stiffness_ = lambda;
  growth_ = 2;
  linearized_ = false;
}

void LogStepper::Linearize() {
  if (linearized_) return;
  {
    const ScopedTimer timer(&phases_->evaluating);
    equations_.Evaluate(current_, Hessian::kGaussNewton, &at_);
    if (added_term_ != nullptr) added_term_->AddTo(current_, &at_);
  }
  const ScopedTimer timer(&phases_->linear_algebra);
  const std::span<const double> x = current_.parameters();
  const size_t n = x.size();
  for (size_t k = 0; k < n; ++k) {
    const double x_k = moves_[k] ? x[k] : 0;
    at_.gradient[k] *= x_k;
    double* const row = &at_.H[k * n];
    for (size_t l = 0; l < n; ++l) row[l] *= x_k * (moves_[l] ? x[l] : 0);
    row[k] += std::max(0.0, at_.gradient[k]);
  }
  roughness_.AddTo(stiffness_ * energy_, y_, &at_);
  linearized_ = true;
}

bool LogStepper::Step() {
  Linearize();
  const size_t n = y_.size();
  std::vector<double> step(n);
  double decrease = 0;  // of (E + penalty) / 2 that the quadratic model predicts
  {
    const ScopedTimer timer(&phases_->linear_algebra);
    while (true) {
      factor_ = at_.H;
      for (size_t k = 0; k < n; ++k) {
        double& diagonal = factor_[k * n + k];
        diagonal = moves_[k] && diagonal > 0 ? (1 + damping_) * diagonal : 1;
        step[k] = moves_[k] ? -at_.gradient[k] : 0;
      }
      if (FactorCholesky(static_cast<int>(n), factor_.data(), objective_.num_threads())) break;
      damping_ *= 10;
      if (exhausted()) return false;
    }
    SolveLower(static_cast<int>(n), factor_.data(), 1, step.data());
    SolveLowerTransposed(static_cast<int>(n), factor_.data(), step.data());
    for (double& move : step) move = std::clamp(move, -kMaxMove, kMaxMove);
    for (size_t k = 0; k < n; ++k) {
      double H_step = 0;
      const double* const row = &at_.H[k * n];
      for (size_t l = 0; l < n; ++l) H_step += row[l] * step[l];
      decrease -= step[k] * (at_.gradient[k] + H_step / 2);
    }
  }
  FactorModel trial = current_;
  for (size_t k = 0; k < n; ++k) {
    if (moves_[k]) trial.parameters()[k] *= std::exp(step[k]);
  }
  std::vector<double> y = Logarithms(trial);
  double E = 0, added = 0;
  {
    const ScopedTimer timer(&phases_->evaluating);
    E = objective_.Value(trial);
    added = AddedAt(trial);
  }
  const double roughness = roughness_(y);
  const double before = minimised(), after = E + stiffness_ * energy_ * roughness + added;
  const double gain = (before - after) / (2 * decrease);
  if (!(after < before && (gain > kMinGainRatio || !(decrease > 0)))) {
    damping_ *= growth_;
    growth_ *= 2;
    return false;
  }
  const double f = 2 * std::clamp(gain, 0.0, 1.0) - 1;
  damping_ = std::max(kMinDamping, damping_ * std::max(kMaxDampingFall, 1 - f * f * f));
  growth_ = 2;
  current_ = std::move(trial);
  y_ = std::move(y);
  E_ = E;
  added_ = added;
  roughness_value_ = roughness;
  linearized_ = false;
  return true;
}

bool LogStepper::exhausted() const { return !(damping_ < kMaxDamping); }

}  // namespace trilobe
