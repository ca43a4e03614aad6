#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "trilobe/solvers/ceres_run.h"
#include "trilobe/solvers/element_step.h"
#include "trilobe/solvers/normal_equations.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// All residuals of an objective as n + 1 in n parameters, with the same cost, gradient and
// Gauss-Newton matrix (docs/solvers.md): with R'R = J'J, upper triangular,
//   r^ = [R^-T J'r; sqrt(E - |R^-T J'r|^2)],   J^ = [R; 0].
// Parameters are those of a FactorModel in units of CeresUnit; with squares, p with x = p^2.
class CondensedCost : public ceres::CostFunction {
 public:
  CondensedCost(const Objective& objective, bool squares, const FactorModel& start,
                PhaseSeconds* phases)
      : objective_(objective),
        equations_(objective),
        squares_(squares),
        unit_(CeresUnit(objective)),
        start_(start),
        phases_(phases) {
    const int n = objective.spec().num_parameters();
    set_num_residuals(n + 1);
    mutable_parameter_block_sizes()->push_back(n);
  }

  std::vector<double> Parameters() const {
    const FactorModel scaled = Scaled(start_, 1 / unit_);
    std::vector<double> p(scaled.parameters().begin(), scaled.parameters().end());
    if (squares_) std::ranges::transform(p, p.begin(), [](double x) { return std::sqrt(x); });
    return p;
  }

  FactorModel Model(const double* p) const {
    FactorModel model = start_;  // dead bins stay as they are, to the last bit
    const std::span<double> x = model.parameters();
    for (size_t k = 0; k < x.size(); ++k) x[k] = squares_ ? p[k] * p[k] : p[k];
    model = Scaled(std::move(model), unit_);
    for (size_t k = 0; k < x.size(); ++k) {
      if (!(objective_.coverage()[k] > 0)) model.parameters()[k] = start_.parameters()[k];
    }
    return model;
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const double* const p = parameters[0];
    const int n = parameter_block_sizes()[0];
    const FactorModel model = Model(p);
    Eigen::Map<Eigen::VectorXd> r(residuals, n + 1);
    r.setZero();
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      r(n) = std::sqrt(objective_.Value(model)) / unit_;
      return std::isfinite(r(n));
    }
    equations_.Evaluate(model, Hessian::kGaussNewton, &at_);
    const ScopedTimer timer(&phases_->linear_algebra);

    // d r / d p = J C / unit, C diagonal: 1 or unit for the change of units, 2 p for squares.
    Eigen::VectorXd chain = Eigen::VectorXd::Constant(n, 1 / unit_);
    chain.head(kChannels * (1 + model.spec().lobes)).setOnes();
    if (squares_) chain = 2 * chain.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(p, n));

    // Columns of length 1 before the factorisation. J'J is singular by the gauge; a perturbation
    // of the size of its rounding errors makes the factor exist.
    Eigen::VectorXd scale(n);
    for (int k = 0; k < n; ++k) {
      scale(k) = at_.squared_lengths[k] > 0 ? 1 / std::sqrt(at_.squared_lengths[k]) : 0;
    }
    Eigen::MatrixXd R = scale.asDiagonal() * Eigen::Map<const Eigen::MatrixXd>(at_.H.data(), n, n) *
                        scale.asDiagonal();
    R.diagonal().array() = 1 + n * std::numeric_limits<double>::epsilon();
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Upper> llt(R);
    if (llt.info() != Eigen::Success) return false;
    const Eigen::VectorXd gradient =
        scale.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(at_.gradient.data(), n));
    r.head(n) = R.triangularView<Eigen::Upper>().transpose().solve(gradient) / unit_;
    const double rest = at_.objective / (unit_ * unit_) - r.head(n).squaredNorm();
    r(n) = std::sqrt(std::max(0.0, rest));

    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor> J(jacobians[0], n + 1, n);
    J.setZero();
    const Eigen::VectorXd unscale = scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0; });
    J.topRows(n).triangularView<Eigen::Upper>() = R * (unscale.cwiseProduct(chain)).asDiagonal();
    return r.allFinite() && J.allFinite();
  }

 private:
  const Objective& objective_;
  mutable NormalEquations equations_;
  mutable QuadraticModel at_;
  const bool squares_;
  const double unit_;
  const FactorModel start_;
  PhaseSeconds* const phases_;
};

class Lm : public Solver {
 public:
  SolverSummary Solve(const Objective& objective, const SolverOptions& options,
                      FactorModel* model) const override {
    Run run("lm", objective, options, model);
    if (options.positivity == Positivity::kActiveSet) {
      run.summary().used.positivity = Positivity::kBounds;
      run.summary().notes.emplace_back(
          "Ceres has no active set, so lm keeps parameters >= 0 by bounds; solver newton has one");
    }
    const bool squares = options.positivity == Positivity::kSquares;
    std::optional<CondensedCost> cost;
    {
      const ScopedTimer timer = run.Time(&PhaseSeconds::preparing);
      cost.emplace(objective, squares, *model, &run.summary().phases);
    }
    std::vector<double> p = cost->Parameters();
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(problem_options);
    problem.AddResidualBlock(&*cost, nullptr, p.data());
    for (int k = 0; k < static_cast<int>(p.size()) && !squares; ++k) {
      problem.SetParameterLowerBound(p.data(), k, 0);
      problem.SetParameterUpperBound(p.data(), k, std::max(p[k], kMaxParameter));
    }
    if (run.Start()) {
      MinimizeWithCeres(
          CeresLinearSolver::kDense, objective.num_threads(), [&] { return cost->Model(p.data()); },
          &problem, &run);
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
