#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "trilobe/model/cost_functors.h"
#include "trilobe/model/parameter_blocks.h"
#include "trilobe/solvers/ceres_run.h"
#include "trilobe/solvers/element_step.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// A sample has 30 to 42 derivatives with the paper's three lobes. Measured there: passes of 8 take
// 1.7 us, of 4 (Ceres' default) 2.5 us, of 14 2.3 us; ceres::AutoDiffCostFunction, all at once with
// every size known to the compiler, 3.9 us.
using CostFunction = ceres::DynamicAutoDiffCostFunction<SampleResidual, /*Stride=*/8>;

// E / unit^2 as a problem for Ceres, with a residual block a sample.
class PlainProblem {
 public:
  PlainProblem(const Objective& objective, const FactorModel& start)
      : unit_(CeresUnit(objective)), model_(start), blocks_(objective.spec()), problem_(Options()) {
    blocks_.Read(Scaled(start, 1 / unit_));
    for (int j = 0; j < objective.samples().size(); ++j) AddSample(objective.Sample(j));
    for (int b = 0; b < blocks_.num_blocks(); ++b) Constrain(b, objective.coverage());
  }

  ceres::Problem* problem() { return &problem_; }

  // The model that the blocks hold now.
  FactorModel Model() {
    blocks_.Write(&model_);
    return Scaled(model_, unit_);
  }

 private:
  static ceres::Problem::Options Options() {
    ceres::Problem::Options options;
    options.disable_all_safety_checks = true;  // a sample names each block once
    return options;
  }

  void AddSample(WeightedSample sample) {
    if (std::ranges::count(sample.weight, 0.0) == kChannels) return;
    for (double& rho : sample.rho) rho /= unit_;
    auto* const cost = new CostFunction(new SampleResidual(blocks_, sample, &block_numbers_));
    cost->SetNumResiduals(SampleResidual::kNumResiduals);
    std::vector<double*> parameters;
    for (const int b : block_numbers_) {
      cost->AddParameterBlock(static_cast<int>(blocks_.block(b).size()));
      parameters.push_back(blocks_.block(b).data());
    }
    problem_.AddResidualBlock(cost, nullptr, parameters);
  }

  // 0 <= x <= kMaxParameter, and dead bins stay as they are.
  void Constrain(int b, const std::vector<double>& coverage) {
    double* const values = blocks_.block(b).data();
    if (!problem_.HasParameterBlock(values)) return;
    const int size = static_cast<int>(blocks_.block(b).size());
    std::vector<int> dead;
    for (int k = 0; k < size; ++k) {
      problem_.SetParameterLowerBound(values, k, 0);
      problem_.SetParameterUpperBound(values, k, std::max(values[k], kMaxParameter));
      if (coverage[blocks_.parameters(b)[k]] == 0) dead.push_back(k);
    }
    if (static_cast<int>(dead.size()) == size) {
      problem_.SetParameterBlockConstant(values);
    } else if (!dead.empty()) {
      problem_.SetManifold(values, new ceres::SubsetManifold(size, dead));
    }
  }

  const double unit_;
  FactorModel model_;
  ParameterBlocks blocks_;
  std::vector<int> block_numbers_;
  ceres::Problem problem_;
};

// The model as one writes it down for Ceres: every sample a residual block with derivatives by
// automatic differentiation, bounds, sparse normal equations.
class LmPlain : public Solver {
 public:
  SolverSummary Solve(const Objective& objective, const SolverOptions& options,
                      FactorModel* model) const override {
    Run run("lm_plain", objective, options, model);
    if (options.positivity != Positivity::kBounds) {
      run.summary().used.positivity = Positivity::kBounds;
      run.summary().notes.emplace_back(
          "lm_plain keeps parameters >= 0 by bounds, whatever is asked");
    }
    std::optional<PlainProblem> problem;
    {
      const ScopedTimer timer = run.Time(&PhaseSeconds::preparing);
      problem.emplace(objective, *model);
    }
    if (run.Start()) {
      MinimizeWithCeres(
          CeresLinearSolver::kSparse, objective.num_threads(), [&] { return problem->Model(); },
          problem->problem(), &run);
    }
    return run.Finish();
  }
};

}  // namespace

SolverEntry LmPlainEntry() {
  return {
      .name = "lm_plain",
      .description = "Levenberg-Marquardt over all samples by Ceres, as one would write it down",
      .reference = "Ceres Solver 2.1, SPARSE_NORMAL_CHOLESKY; Marquardt 1963",
      .options = {"positivity", "trust_region"},
      .make = [] { return std::make_unique<LmPlain>(); }};
}

}  // namespace trilobe
