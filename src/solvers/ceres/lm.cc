#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/algebra/cholesky.h"
#include "solvers/ceres/ceres_run.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {
namespace {

// All residuals of an objective as n + 1 in n parameters, with the same cost, gradient and
// Gauss-Newton matrix (docs/solvers.md): with R'R = J'J, upper triangular,
//   r^ = [R^-T J'r; sqrt(E - |R^-T J'r|^2)],   J^ = [R; 0].
class CondensedCost : public ceres::CostFunction {
 public:
  CondensedCost(const Objective& objective, const CeresParameters& parameters, PhaseSeconds* phases)
      : objective_(objective), equations_(objective), parameters_(parameters), phases_(phases) {
    const int n = objective.spec().num_parameters();
    set_num_residuals(n + 1);
    mutable_parameter_block_sizes()->push_back(n);
  }

  // The model of Ceres' parameters p, and E if it was the last that residuals were asked for.
  CeresPoint Point(const double* p) const {
    CeresPoint point{.model = Model(p)};
    if (IsLast(p)) point.objective = last_objective_;
    return point;
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const double* const p = parameters[0];
    const int n = parameter_block_sizes()[0];
    std::fill_n(residuals, n + 1, 0.0);
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      residuals[n] = std::sqrt(Value(p)) / parameters_.residual_unit();
      return std::isfinite(residuals[n]);
    }
    equations_.Evaluate(Model(p), Hessian::kGaussNewton, &at_);
    const ScopedTimer timer(&phases_->linear_algebra);
    return Condense(p, residuals, jacobians[0]);
  }

 private:
  FactorModel Model(const double* p) const {
    FactorModel x(objective_.spec());
    std::copy_n(p, x.parameters().size(), x.parameters().begin());
    return parameters_.Model(std::move(x));
  }

  bool IsLast(const double* p) const {
    return !last_.empty() && std::equal(last_.begin(), last_.end(), p);
  }

  // E. Ceres asks for it twice at each trial point: in its line search, and to judge the step.
  double Value(const double* p) const {
    if (!IsLast(p)) {
      last_objective_ = objective_.Value(Model(p));
      last_.assign(p, p + parameter_block_sizes()[0]);
    }
    return last_objective_;
  }

  // r^ and J^ from J'J and J'r at p. `R` [n + 1][n] is by rows, so that R's upper triangle is the
  // lower one, by columns, in which FactorCholesky works.
  bool Condense(const double* p, double* residuals, double* R) const {
    const size_t n = at_.gradient.size();
    std::fill_n(R, (n + 1) * n, 0.0);
    // Columns of length 1 before the factorisation. J'J is singular by the gauge; a perturbation
    // of the size of its rounding errors makes the factor exist.
    std::vector<double> scale(n);
    for (size_t k = 0; k < n; ++k) {
      scale[k] = at_.squared_lengths[k] > 0 ? 1 / std::sqrt(at_.squared_lengths[k]) : 0;
    }
    for (size_t k = 0; k < n; ++k) {
      for (size_t l = k + 1; l < n; ++l) R[k * n + l] = scale[k] * scale[l] * at_.H[k * n + l];
      R[k * n + k] = 1 + static_cast<double>(n) * std::numeric_limits<double>::epsilon();
      residuals[k] = scale[k] * at_.gradient[k];
    }
    if (!FactorCholesky(static_cast<int>(n), R, objective_.num_threads())) return false;
    SolveLower(static_cast<int>(n), R, 1, residuals);
    double rest = at_.objective;
    for (size_t k = 0; k < n; ++k) rest -= residuals[k] * residuals[k];
    residuals[n] = std::sqrt(std::max(0.0, rest));

    // d (r / unit) / dp = J C, C diagonal: value_unit / unit or 1 / unit for the change of units; 0
    // for what is held.
    const double unit = parameters_.residual_unit();
    for (size_t k = 0; k <= n; ++k) residuals[k] /= unit;
    const size_t num_in_units = kChannels * (1 + objective_.spec().lobes);  // d and s
    std::vector<double> column(n);
    for (size_t k = 0; k < n; ++k) {
      column[k] = std::sqrt(at_.squared_lengths[k]) *
                  (k < num_in_units ? parameters_.value_unit() : 1) / unit;
      if (parameters_.IsHeld(p[k], at_.gradient[k])) column[k] = 0;
    }
    for (size_t k = 0; k < n; ++k) {
      for (size_t l = k; l < n; ++l) R[k * n + l] *= column[l];
    }
    const auto is_finite = [](double x) { return std::isfinite(x); };
    return std::all_of(residuals, residuals + n + 1, is_finite) &&
           std::all_of(R, R + n * n, is_finite);
  }

  const Objective& objective_;
  mutable NormalEquations equations_;
  mutable QuadraticModel at_;
  const CeresParameters& parameters_;
  PhaseSeconds* const phases_;
  mutable std::vector<double> last_;
  mutable double last_objective_ = 0;
};

class Lm : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("lm", objective, options, model);
    const CeresParameters parameters(objective, *model, CeresParameters::ActiveSet::kInCost, &run);
    std::optional<CondensedCost> cost;
    {
      const ScopedTimer timer = run.Time(&PhaseSeconds::preparing);
      cost.emplace(objective, parameters, &run.summary().phases);
    }
    FactorModel start = parameters.Start();
    const std::span<double> p = start.parameters();
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(problem_options);
    problem.AddResidualBlock(&*cost, nullptr, p.data());
    parameters.SetBounds(p, &problem);
    if (run.Start()) {
      MinimizeWithCeres(
          CeresLinearSolver::kDenseCholesky, objective.num_threads(),
          [&] { return cost->Point(p.data()); }, &problem, &run);
    }
    return run.Finish();
  }
};

}  // namespace

SolverEntry LmEntry() {
  return {.name = "lm",
          .description = "lm_plain's problem condensed to one small block for Ceres",
          .reference = "Ceres Solver 2.1, DENSE_NORMAL_CHOLESKY; docs/solvers.md",
          .options = {"positivity", "trust_region"},
          .make = [] { return std::make_unique<Lm>(); }};
}

}  // namespace trilobe
