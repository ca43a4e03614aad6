#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "model/objective/cost_functors.h"
#include "model/objective/parameter_blocks.h"
#include "solvers/ceres/ceres_run.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// A sample has 30 to 42 derivatives with the paper's three lobes. Measured there: passes of 8 take
// 1.7 us, of 4 (Ceres' default) 2.5 us, of 14 2.3 us; ceres::AutoDiffCostFunction, all at once with
// every size known to the compiler, 3.9 us.
constexpr int kStride = 8;

// QR of the whole Jacobian where that takes no more than this. There a step by QR takes half a
// second, some ten times what one by sparse normal equations takes.
constexpr double kMaxDenseBytes = 64 << 20;

// E / residual_unit^2 as a problem for Ceres, with a residual block a sample.
class PlainProblem {
 public:
  PlainProblem(const Objective& objective, const CeresParameters& parameters)
      : parameters_(parameters), blocks_(objective.spec()), problem_(Options()) {
    blocks_.Read(parameters.Start());
    for (int j = 0; j < objective.samples().size(); ++j) {
      const WeightedSample sample = objective.Sample(j);
      if (std::ranges::count(sample.weight, 0.0) == kChannels) continue;
      AddSample(sample);
    }
    for (int b = 0; b < blocks_.num_blocks(); ++b) Constrain(b, objective.coverage());
  }

  ceres::Problem* problem() { return &problem_; }

  CeresLinearSolver linear_solver() const {
    const double bytes = 8.0 * problem_.NumResiduals() * problem_.NumParameters();
    return bytes <= kMaxDenseBytes ? CeresLinearSolver::kDenseQr
                                   : CeresLinearSolver::kSparseCholesky;
  }

  // The model that the blocks hold now.
  FactorModel Model() const {
    FactorModel p(blocks_.spec());
    blocks_.Write(&p);
    return parameters_.Model(std::move(p));
  }

 private:
  static ceres::Problem::Options Options() {
    ceres::Problem::Options options;
    options.disable_all_safety_checks = true;  // a sample names each block once
    return options;
  }

  void AddSample(WeightedSample sample) {
    const double unit = parameters_.value_unit(), ratio = unit / parameters_.residual_unit();
    for (double& rho : sample.rho) rho /= unit;
    for (double& w : sample.weight) w *= ratio * ratio;
    auto* const cost = new ceres::DynamicAutoDiffCostFunction<SampleResidual, kStride>(
        new SampleResidual(blocks_, sample, &block_numbers_));
    cost->SetNumResiduals(SampleResidual::kNumResiduals);
    std::vector<double*> parameters;
    for (const int b : block_numbers_) {
      cost->AddParameterBlock(static_cast<int>(blocks_.block(b).size()));
      parameters.push_back(blocks_.block(b).data());
    }
    problem_.AddResidualBlock(cost, nullptr, parameters);
  }

  // Bounds, and unobserved bins stay as they are.
  void Constrain(int b, const std::vector<double>& coverage) {
    double* const values = blocks_.block(b).data();
    if (!problem_.HasParameterBlock(values)) return;
    const int size = static_cast<int>(blocks_.block(b).size());
    std::vector<int> unobserved;
    parameters_.SetBounds(blocks_.block(b), &problem_);
    for (int k = 0; k < size; ++k) {
      if (coverage[blocks_.parameters(b)[k]] == 0) unobserved.push_back(k);
    }
    if (static_cast<int>(unobserved.size()) == size) {
      problem_.SetParameterBlockConstant(values);
    } else if (!unobserved.empty()) {
      problem_.SetManifold(values, new ceres::SubsetManifold(size, unobserved));
    }
  }

  const CeresParameters& parameters_;
  ParameterBlocks blocks_;
  std::vector<int> block_numbers_;
  ceres::Problem problem_;
};

// The model as one writes it down for Ceres: every sample a residual block with derivatives by
// automatic differentiation.
class LmPlain : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("lm_plain", objective, options, model);
    const CeresParameters parameters(objective, *model, CeresParameters::ActiveSet::kNone, &run);
    std::optional<PlainProblem> problem;
    {
      const ScopedTimer timer = run.Time(&PhaseSeconds::preparing);
      problem.emplace(objective, parameters);
    }
    if (run.Start()) {
      MinimizeWithCeres(
          problem->linear_solver(), objective.num_threads(),
          [&] { return CeresPoint{.model = problem->Model()}; }, problem->problem(), &run);
    }
    return run.Finish();
  }
};

}  // namespace

SolverEntry LmPlainEntry() {
  return {
      .name = "lm_plain",
      .description = "Levenberg-Marquardt over all samples by Ceres, as one would write it down",
      .reference = "Ceres Solver 2.1, SPARSE_NORMAL_CHOLESKY or DENSE_QR; Marquardt 1963",
      .options = {"positivity", "trust_region"},
      .make = [] { return std::make_unique<LmPlain>(); }};
}

}  // namespace trilobe
