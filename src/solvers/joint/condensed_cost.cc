#include "solvers/joint/condensed_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/algebra/symmetric_matrix.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/solvers/run.h"

namespace trilobe {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

bool AllFinite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
}

}  // namespace

CondensedSums::CondensedSums(const CeresParameters& parameters, std::span<const double> p,
                             bool active_set, PhaseSeconds* phases)
    : parameters_(parameters),
      p_(p),
      active_set_(active_set),
      phases_(phases),
      equations_(parameters.objective()),
      held_(p.size(), false) {}

FactorModel CondensedSums::Model() const {
  FactorModel x(parameters_.objective().spec());
  std::ranges::copy(p_, x.parameters().begin());
  for (size_t k = 0; k < p_.size(); ++k) {
    if (held_[k]) x.parameters()[k] = 0;
  }
  return parameters_.Model(std::move(x));
}

CeresPoint CondensedSums::Point() const {
  CeresPoint point{.model = Model()};
  if (std::ranges::equal(valued_, p_)) point.objective = value_;
  return point;
}

void CondensedSums::PrepareForEvaluation(bool evaluate_jacobians, bool /*new_evaluation_point*/) {
  is_linearization_ = evaluate_jacobians;
  if (evaluate_jacobians) {
    Linearize();
    return;
  }
  // Ceres' line search for bounds and its judgement of the step ask for the same point.
  if (!std::ranges::equal(valued_, p_)) {
    value_ = parameters_.objective().Value(Model());
    valued_.assign(p_.begin(), p_.end());
  }
  cost_ = value_ / parameters_.residual_unit() / parameters_.residual_unit();
  valid_ = std::isfinite(cost_);
}

void CondensedSums::Linearize() {
  held_.assign(p_.size(), false);
  x0_.assign(p_.begin(), p_.end());
  equations_.Evaluate(Model(), Hessian::kGaussNewton, &at_);
  const ScopedTimer timer(&phases_->linear_algebra);
  for (size_t k = 0; k < p_.size(); ++k) {
    held_[k] = active_set_ && p_[k] <= 0 && at_.gradient[k] > 0;
  }
  valid_ = Condense();
}

// R and the residuals, from J'J and J'r.
bool CondensedSums::Condense() {
  const size_t n = p_.size();
  R_.assign((n + 1) * n, 0.0);
  residuals_.assign(n + 1, 0.0);
  // Columns of length 1 before the factorisation. J'J is singular by the gauge; a perturbation of
  // the size of its rounding errors makes the factor exist. By rows, R's upper triangle is the
  // lower one, by columns, in which FactorCholesky works.
  std::vector<double> scale(n);
  for (size_t k = 0; k < n; ++k) {
    scale[k] = at_.squared_lengths[k] > 0 ? 1 / std::sqrt(at_.squared_lengths[k]) : 0;
  }
  for (size_t k = 0; k < n; ++k) {
    for (size_t l = k + 1; l < n; ++l) R_[k * n + l] = scale[k] * scale[l] * at_.H[k * n + l];
    R_[k * n + k] = 1 + static_cast<double>(n) * kEpsilon;
    residuals_[k] = scale[k] * at_.gradient[k];
  }
  const Objective& objective = parameters_.objective();
  if (!FactorCholesky(static_cast<int>(n), R_.data(), objective.num_threads())) return false;
  SolveLower(static_cast<int>(n), R_.data(), 1, residuals_.data());
  double rest = at_.objective;
  for (size_t k = 0; k < n; ++k) rest -= residuals_[k] * residuals_[k];
  // Above 0, so that m never vanishes.
  residuals_[n] = std::sqrt(std::max(kEpsilon * kEpsilon * at_.objective, rest));

  // d (r / unit) / dp = J C, C diagonal: value_unit / unit or 1 / unit for the change of units; 0
  // for what is held.
  const double unit = parameters_.residual_unit();
  for (double& r : residuals_) r /= unit;
  const size_t num_in_units = kChannels * (1 + objective.spec().lobes);  // d and s
  std::vector<double> column(n, 0.0);
  for (size_t k = 0; k < n; ++k) {
    if (held_[k]) continue;
    column[k] = std::sqrt(at_.squared_lengths[k]) *
                (k < num_in_units ? parameters_.value_unit() : 1) / unit;
  }
  for (size_t k = 0; k < n; ++k) {
    for (size_t l = k; l < n; ++l) R_[k * n + l] *= column[l];
  }
  return AllFinite(residuals_) && AllFinite(R_);
}

CondensedCost::CondensedCost(const CondensedSums* sums) : sums_(*sums) {
  set_num_residuals(sums_.num_parameters() + 1);
  mutable_parameter_block_sizes()->push_back(sums_.num_parameters());
}

bool CondensedCost::Evaluate(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  if (!sums_.valid()) return false;
  std::ranges::copy(sums_.residuals(), residuals);  // m(x0) = r^(x0)
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    std::ranges::copy(sums_.R(), jacobians[0]);
    return sums_.is_linearization();
  }
  if (sums_.is_linearization()) return true;
  const size_t n = sums_.num_parameters();
  std::vector<double> moved(n);
  for (size_t k = 0; k < n; ++k) moved[k] = parameters[0][k] - sums_.x0()[k];
  double squared_length = residuals[n] * residuals[n];
  for (size_t k = 0; k < n; ++k) {
    const double* const row = sums_.R().data() + k * n;
    for (size_t l = k; l < n; ++l) residuals[k] += row[l] * moved[l];
    squared_length += residuals[k] * residuals[k];
  }
  const double stretch = std::sqrt(sums_.cost() / squared_length);
  for (size_t k = 0; k <= n; ++k) residuals[k] *= stretch;
  return AllFinite({residuals, n + 1});
}

}  // namespace trilobe
