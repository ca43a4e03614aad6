#include "solvers/joint/plain_problem.h"

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <ceres/manifold.h>
#include <ceres/ordered_groups.h>

#include <algorithm>
#include <memory>
#include <span>

#include "trilobe/model/objective/sample_residual.h"

namespace trilobe {
namespace {

// A sample has 30 to 42 derivatives with the paper's three lobes. Measured there with
// ceres::DynamicAutoDiffCostFunction: passes of 8 take 1.7 us, of 4 (Ceres' default) 2.5 us, of 14
// 2.3 us; ceres::AutoDiffCostFunction, all at once with every size known to the compiler, 3.9 us.
constexpr size_t kStride = 8;

// QR of the whole Jacobian where that takes no more than this. There a step by QR takes half a
// second, some ten times what one by sparse normal equations takes.
constexpr double kMaxDenseBytes = 64 << 20;

// ceres::DynamicAutoDiffCostFunction of a sample, but its evaluations allocate nothing.
class SampleCost : public ceres::CostFunction {
 public:
  // *blocks receives the numbers of the blocks that the sample reads.
  SampleCost(const ParameterBlocks& layout, const WeightedSample& sample, std::vector<int>* blocks)
      : residual_(layout, sample, blocks) {
    set_num_residuals(SampleResidual::kNumResiduals);
    for (const int b : *blocks) {
      mutable_parameter_block_sizes()->push_back(static_cast<int>(layout.block(b).size()));
    }
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    if (jacobians == nullptr) return residual_(parameters, residuals);
    // These keep their storage from one evaluation on a thread to the next.
    thread_local std::vector<Jet> x;
    thread_local std::vector<const Jet*> blocks;
    const std::vector<int>& sizes = parameter_block_sizes();
    x.clear();
    for (size_t b = 0; b < sizes.size(); ++b) {
      for (int k = 0; k < sizes[b]; ++k) x.emplace_back(parameters[b][k]);
    }
    blocks.clear();
    for (const Jet* block = x.data(); const int size : sizes) {
      blocks.push_back(block);
      block += size;
    }
    size_t b = 0;
    int k = 0;  // derivatives by entry k of block b are next
    for (size_t begin = 0; begin < x.size(); begin += kStride) {
      const std::span<Jet> pass(&x[begin], std::min(kStride, x.size() - begin));
      for (size_t i = 0; i < pass.size(); ++i) pass[i].v[i] = 1;
      Jet results[SampleResidual::kNumResiduals];
      residual_(blocks.data(), results);
      for (size_t i = 0; i < pass.size(); ++i) {
        pass[i].v[i] = 0;
        for (int C = 0; C < num_residuals(); ++C) {
          residuals[C] = results[C].a;
          if (jacobians[b] != nullptr) jacobians[b][C * sizes[b] + k] = results[C].v[i];
        }
        if (++k == sizes[b]) ++b, k = 0;
      }
    }
    return true;
  }

 private:
  using Jet = ceres::Jet<double, kStride>;

  SampleResidual residual_;
};

ceres::Problem::Options ProblemOptions() {
  ceres::Problem::Options options;
  options.disable_all_safety_checks = true;  // a sample names each block once
  return options;
}

}  // namespace

PlainProblem::PlainProblem(const CeresParameters& parameters)
    : parameters_(parameters), blocks_(parameters.objective().spec()), problem_(ProblemOptions()) {
  const Objective& objective = parameters.objective();
  blocks_.Read(parameters.Start());
  for (int j = 0; j < objective.samples().size(); ++j) {
    const WeightedSample sample = objective.Sample(j);
    if (std::ranges::count(sample.weight, 0.0) < kChannels) AddSample(sample);
  }
  for (int b = 0; b < blocks_.num_blocks(); ++b) Constrain(b, objective.coverage());
}

void PlainProblem::AddSample(WeightedSample sample) {
  const double unit = parameters_.value_unit(), ratio = unit / parameters_.residual_unit();
  for (double& rho : sample.rho) rho /= unit;
  for (double& w : sample.weight) w *= ratio * ratio;
  auto cost = std::make_unique<SampleCost>(blocks_, sample, &block_numbers_);
  std::vector<double*> parameters;
  for (const int b : block_numbers_) parameters.push_back(blocks_.block(b).data());
  problem_.AddResidualBlock(cost.release(), nullptr, parameters);

  if (blocks_.spec().lobes == 0) return;
  const int begin = blocks_.row(Factor::kD, 0), end = blocks_.row(Factor::kF, 0);
  for (const int a : block_numbers_) {
    for (const int b : block_numbers_) {
      if (begin <= a && a < b && b < end) together_.emplace(a, b);
    }
  }
}

void PlainProblem::Constrain(int b, const std::vector<double>& coverage) {
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

LinearSolver PlainProblem::Choose(LinearSolver asked) const {
  if (asked != LinearSolver::kAuto) return asked;
  const double bytes = 8.0 * problem_.NumResiduals() * problem_.NumParameters();
  return bytes <= kMaxDenseBytes ? LinearSolver::kDenseQr : LinearSolver::kSparseNormalCholesky;
}

std::vector<int> PlainProblem::IndependentRows() const {
  std::vector<int> independent;
  if (blocks_.spec().lobes == 0) return independent;
  for (int row = blocks_.row(Factor::kD, 0); row < blocks_.row(Factor::kF, 0); ++row) {
    const bool meets = std::ranges::any_of(independent, [&](int b) {
      return together_.contains({b, row});
    });
    if (!meets && problem_.HasParameterBlock(blocks_.block(row).data())) independent.push_back(row);
  }
  return independent;
}

ceres::Solver::Options PlainProblem::OptionsFor(const SolverOptions& options, int num_threads) {
  ceres::Solver::Options ceres_options = CeresOptions(options, options.linear_solver, num_threads);
  ceres_options.use_inner_iterations = options.inner_iterations;
  if (!ceres::IsSchurType(ceres_options.linear_solver_type)) return ceres_options;
  const std::vector<int> first = IndependentRows();
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (int b = 0; b < blocks_.num_blocks(); ++b) {
    double* const values = blocks_.block(b).data();
    if (!problem_.HasParameterBlock(values)) continue;
    ordering->AddElementToGroup(values, std::ranges::binary_search(first, b) ? 0 : 1);
  }
  ceres_options.linear_solver_ordering = std::move(ordering);
  return ceres_options;
}

FactorModel PlainProblem::Model() const {
  FactorModel p(blocks_.spec());
  blocks_.Write(&p);
  return parameters_.Model(std::move(p));
}

}  // namespace trilobe
