#ifndef TRILOBE_EXPERIMENTS_STIFF_MINIMIZE_H_
#define TRILOBE_EXPERIMENTS_STIFF_MINIMIZE_H_

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "experiments/stiff/reference_problem.h"

namespace trilobe {

// End of a reference minimisation.
template <typename Real>
struct Minimum {
  VectorOf<Real> x;
  Real objective = 0;
  // The largest projected component of the gradient in the scale in which columns of J have length
  // 1, over |r| (docs/solvers.md, "Optimality").
  Real optimality = 0;
  Real relative_decrease = 0;  // relative decrease of E that a further Newton step promises
  bool converged = false;      // relative_decrease is at the precision's level
  int iterations = 0;
};

// Damped Newton steps with the exact Hessian and an active set for x >= 0, in any precision.
template <typename Real>
class ReferenceMinimizer {
 public:
  explicit ReferenceMinimizer(const ReferenceProblem<Real>& problem)
      : problem_(problem),
        measured_energy_(problem.MeasuredEnergy()),
        precision_(std::numeric_limits<Real>::epsilon()) {}

  Minimum<Real> Minimize(VectorOf<Real> x, int max_iterations);

 private:
  struct Step {
    VectorOf<Real> x;
    Real predicted_decrease = 0;  // in units of E / 2
  };

  void SetMetric();
  // Nothing where the damped Hessian of what is free to move is not positive definite.
  std::optional<Step> SolveStep(const VectorOf<Real>& x, const Real& lambda) const;
  Real Optimality(const VectorOf<Real>& x) const;

  const ReferenceProblem<Real>& problem_;
  const Real measured_energy_;
  const Real precision_;
  Derivatives<Real> at_;
  VectorOf<Real> metric_;  // metric of the damping; 0 where a parameter cannot move
};

// --- Implementation -----------------------------------------------------------------------------

// The lengths of the columns of J, none less than a thousandth of the root mean square of its part.
template <typename Real>
void ReferenceMinimizer<Real>::SetMetric() {
  using std::sqrt;
  const VectorOf<Real> squares = at_.JtJ.diagonal();
  metric_ = VectorOf<Real>::Zero(squares.size());
  for (const auto [begin, size] : FactorModel(problem_.spec()).Parts()) {
    const Real floor = squares.segment(begin, size).mean() * Real{1e-6};
    for (int k = begin; k < begin + size; ++k) {
      if (squares(k) > 0) metric_(k) = sqrt(squares(k) > floor ? squares(k) : floor);
    }
  }
}

// In the scale z = metric x.
template <typename Real>
std::optional<typename ReferenceMinimizer<Real>::Step> ReferenceMinimizer<Real>::SolveStep(
    const VectorOf<Real>& x, const Real& lambda) const {
  const int n = static_cast<int>(x.size());
  VectorOf<Real> step = VectorOf<Real>::Zero(n);
  std::vector<bool> free(n);
  for (int k = 0; k < n; ++k) free[k] = metric_(k) > 0 && (x(k) > 0 || at_.gradient(k) < 0);
  const auto H = at_.hessian.template selfadjointView<Eigen::Lower>();
  for (bool changed = true; changed;) {
    std::vector<int> of_free;
    for (int k = 0; k < n; ++k) {
      if (free[k]) of_free.push_back(k);
    }
    const int size = static_cast<int>(of_free.size());
    for (const int k : of_free) step(k) = 0;
    const VectorOf<Real> slope = at_.gradient + H * step;
    MatrixOf<Real> A(size, size);
    VectorOf<Real> b(size);
    for (int i = 0; i < size; ++i) {
      const int k = of_free[i];
      b(i) = -slope(k) / metric_(k);
      for (int j = 0; j <= i; ++j) {
        A(i, j) = at_.hessian(k, of_free[j]) / (metric_(k) * metric_(of_free[j]));
      }
      A(i, i) += lambda;
    }
    const Eigen::LLT<MatrixOf<Real>> factor(A);
    if (factor.info() != Eigen::Success) return std::nullopt;
    b = factor.solve(b).eval();
    changed = false;
    for (int i = 0; i < size; ++i) {
      const int k = of_free[i];
      step(k) = b(i) / metric_(k);
      if (x(k) + step(k) >= 0) continue;
      step(k) = -x(k);
      free[k] = false;
      changed = true;
    }
  }
  const VectorOf<Real> H_step = H * step;
  return Step{(x + step).cwiseMax(Real{0}), -(at_.gradient + H_step / Real{2}).dot(step)};
}

template <typename Real>
Real ReferenceMinimizer<Real>::Optimality(const VectorOf<Real>& x) const {
  using std::sqrt;
  if (!(at_.objective > 0)) return Real{0};
  Real largest(0);
  for (int k = 0; k < x.size(); ++k) {
    const Real length = sqrt(at_.JtJ(k, k));
    if (!(length > 0)) continue;
    const Real g = at_.gradient(k) / length, z = x(k) * length;
    const Real step = g > 0 ? (g < z ? g : z) : static_cast<Real>(-g);
    if (step > largest) largest = step;
  }
  return largest / sqrt(at_.objective);
}

template <typename Real>
Minimum<Real> ReferenceMinimizer<Real>::Minimize(VectorOf<Real> x, int max_iterations) {
  using std::pow;
  const Real min_lambda = pow(precision_, Real{0.6}), max_lambda(1e20);
  const Real enough = pow(precision_, Real{0.65});  // relative decrease of E
  // E of values that are off by a hundred rounding errors.
  const Real zero = Real{1e4} * precision_ * precision_ * measured_energy_;
  Minimum<Real> minimum;
  Real lambda(1e-3), growth(2);
  at_ = problem_.Evaluate(x);
  SetMetric();
  while (true) {
    if (at_.objective <= zero) minimum.converged = true;
    if (minimum.converged || minimum.iterations == max_iterations || lambda > max_lambda) break;
    const std::optional<Step> step = SolveStep(x, lambda);
    if (!step || !(step->predicted_decrease > 0)) {
      minimum.converged = step && step->x == x;  // nothing wants to move
      lambda = std::max<Real>(4 * lambda, Real{1e-8});
      continue;
    }
    ++minimum.iterations;
    minimum.relative_decrease = 2 * step->predicted_decrease / at_.objective;
    const Real E = problem_.Value(step->x);
    const Real gain = (at_.objective - E) / (2 * step->predicted_decrease);
    if (minimum.relative_decrease <= enough && lambda <= Real{1e-3}) minimum.converged = true;
    if (!(E < at_.objective && gain > Real{1e-4})) {
      lambda *= growth;
      growth *= 2;
      continue;
    }
    const Real f = 2 * gain - 1;
    lambda = std::max<Real>(min_lambda, lambda * std::max<Real>(Real{0.1}, 1 - f * f * f));
    growth = 2;
    x = step->x;
    at_ = problem_.Evaluate(x);
    SetMetric();
  }
  minimum.x = x;
  minimum.objective = at_.objective;
  minimum.optimality = Optimality(x);
  // Near the minimum steps converge quadratically, where E can no longer tell whether they do.
  // While the gradient is not 0, neither is the curvature along the gauge: it may be negative.
  for (bool better = minimum.converged; better;) {
    std::optional<Step> step;
    for (lambda = min_lambda; !step && lambda < Real{1e-3}; lambda *= 100) {
      step = SolveStep(x, lambda);
    }
    if (!step) break;
    x = step->x;
    at_ = problem_.Evaluate(x);
    const Real optimality = Optimality(x);
    better = optimality < minimum.optimality && at_.objective <= minimum.objective * (1 + enough);
    if (!better) break;
    minimum.x = x;
    minimum.objective = at_.objective;
    minimum.optimality = optimality;
  }
  return minimum;
}

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_STIFF_MINIMIZE_H_
