#include "trilobe/solvers/nonnegative_step.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "trilobe/solvers/cholesky.h"
#include "trilobe/solvers/element_step.h"

namespace trilobe {
namespace {

// Holding and freeing at once converges in few rounds, but may cycle; holding alone ends.
constexpr int kExchangeRounds = 4;
constexpr int kMaxRounds = 10;

using ConstVectorMap = Eigen::Map<const Eigen::VectorXd>;

}  // namespace

void NonnegativeStep::MoveTo(const QuadraticModel& at, std::span<const double> x) {
  at_ = &at;
  x_.assign(x.begin(), x.end());
  const size_t n = x.size();
  for (auto* of_all : {&scale_, &unit_, &g_, &z_, &p_, &u_}) of_all->assign(n, 0.0);
  binding_.assign(n, false);
  for (size_t k = 0; k < n; ++k) {
    if (!(at.squared_lengths[k] > 0)) continue;
    scale_[k] = std::sqrt(at.squared_lengths[k]);
    unit_[k] = 1 / scale_[k];
    g_[k] = unit_[k] * at.gradient[k];
    z_[k] = scale_[k] * x[k];
    binding_[k] = z_[k] == 0 && g_[k] > 0;
  }
}

NonnegativeStep::Result NonnegativeStep::Solve(double lambda) {
  Outcome outcome = Outcome::kChanged;
  for (int round = 0; outcome == Outcome::kChanged && round < kMaxRounds; ++round) {
    outcome = SolveFree(lambda, round < kExchangeRounds);
  }
  Result result{.x = x_};
  if (outcome == Outcome::kIndefinite) return result;
  const size_t n = x_.size();
  for (size_t k = 0; k < n; ++k) {
    if (unit_[k] == 0) continue;
    p_[k] = std::max(p_[k], -z_[k]);
    u_[k] = unit_[k] * p_[k];
    const double moved = z_[k] + p_[k];
    result.x[k] = moved > 0 ? std::min(moved / scale_[k], kMaxParameter) : 0;
  }
  const int size = static_cast<int>(n);
  const ConstVectorMap g(g_.data(), size), p(p_.data(), size), u(u_.data(), size);
  const Eigen::Map<const Eigen::MatrixXd> H(at_->H.data(), size, size);
  const Eigen::VectorXd H_u = H.selfadjointView<Eigen::Lower>() * u;
  result.predicted_decrease = -(g.dot(p) + u.dot(H_u) / 2);
  return result;
}

// Row k of the scaled H times p.
double NonnegativeStep::H_p(size_t k) const {
  const int n = static_cast<int>(u_.size());
  return unit_[k] * ConstVectorMap(&at_->H[k * u_.size()], n).dot(ConstVectorMap(u_.data(), n));
}

// Sets p by the present active set, then changes that.
NonnegativeStep::Outcome NonnegativeStep::SolveFree(double lambda, bool release) {
  const size_t n = x_.size();
  free_.clear();
  held_.clear();
  units_.clear();
  bool moved = false;
  for (size_t k = 0; k < n; ++k) {
    p_[k] = u_[k] = 0;
    if (unit_[k] == 0) continue;
    (binding_[k] ? held_ : free_).push_back(k);
    if (!binding_[k]) {
      units_.push_back(unit_[k]);
    } else if (z_[k] != 0) {
      p_[k] = -z_[k];
      u_[k] = unit_[k] * p_[k];
      moved = true;
    }
  }
  const size_t num_free = free_.size();
  A_.resize(num_free * num_free);
  step_.resize(num_free);
  for (size_t j = 0; j < num_free; ++j) {
    const size_t k = free_[j];
    step_[j] = -(moved ? g_[k] + H_p(k) : g_[k]);  // with the held ones at 0
    const double* const H_k = &at_->H[k * n];
    double* const column = &A_[j * num_free];
    for (size_t i = j; i < num_free; ++i) column[i] = units_[j] * H_k[free_[i]] * units_[i];
    column[j] += lambda;
  }
  if (!FactorCholesky(static_cast<int>(num_free), A_.data())) return Outcome::kIndefinite;
  SolveCholesky(static_cast<int>(num_free), A_.data(), step_.data());
  if (!ConstVectorMap(step_.data(), static_cast<int>(num_free)).allFinite()) {
    return Outcome::kIndefinite;
  }
  bool changed = false;
  for (size_t j = 0; j < num_free; ++j) {
    const size_t k = free_[j];
    p_[k] = step_[j];
    u_[k] = unit_[k] * p_[k];
    if (z_[k] + p_[k] >= 0) continue;
    binding_[k] = changed = true;
  }
  if (release) {
    for (const size_t k : held_) {
      if (g_[k] + H_p(k) + lambda * p_[k] >= 0) continue;
      binding_[k] = false;
      changed = true;
    }
  }
  return changed ? Outcome::kChanged : Outcome::kRight;
}

}  // namespace trilobe
