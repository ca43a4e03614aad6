// How far J'J, which has the square of J's condition number, can be trusted (docs/solvers.md).

#include <ceres/dynamic_autodiff_cost_function.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <span>
#include <vector>

#include "core/algebra/symmetric_matrix.h"
#include "tests/test_util.h"
#include "trilobe/model/objective/parameter_blocks.h"
#include "trilobe/model/objective/sample_residual.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 10};
// Gauge freedoms of two lobes with an F per channel: scale moves between s, D and G of each lobe,
// and between s and F of each channel.
constexpr int kGaugeDimensions = 2 * 2 + 3;

// Two lobes, of which each number of the second is that of the first but for about `difference`,
// relative.
FactorModel NearlyEqualLobes(double difference) {
  FactorModel model = RandomModel(ModelSpec::SharedFactors(2, kGrid), 1, 0.3);
  Random random(2);
  const auto copy = [&](std::span<const double> from, std::span<double> target) {
    for (size_t k = 0; k < target.size(); ++k) {
      target[k] = from[k] * (1 + difference * random.Normal());
    }
  };
  copy(model.s(0), model.s(1));
  for (const Factor factor : {Factor::kD, Factor::kG}) {
    copy(model.table(factor, 0), model.table(factor, 1));
  }
  return model;
}

// A measurement that the model is some 10 % off.
Objective NoisyObjective(const FactorModel& model) {
  BrdfTable table = TableOf(model, kGrid);
  Random random(3);
  for (std::vector<double>& channel : table.stored) {
    for (double& value : channel) value *= random.LogNormal(0.1);
  }
  return MakeObjective(table, model.spec());
}

struct Linearization {
  MatrixXd J;
  VectorXd r;
};

// J and r by automatic differentiation, sample by sample.
Linearization Linearize(const Objective& objective, const FactorModel& model) {
  ParameterBlocks layout(model.spec());
  layout.Read(model);
  const std::vector<WeightedSample>& samples = objective.weighted_samples();
  const auto rows = static_cast<Eigen::Index>(kChannels * samples.size());
  Linearization at{.J = MatrixXd::Zero(rows, model.spec().num_parameters()), .r = VectorXd(rows)};
  std::vector<int> numbers;
  Eigen::Index row = 0;
  for (const WeightedSample& sample : samples) {
    ceres::DynamicAutoDiffCostFunction<SampleResidual, 8> cost(
        new SampleResidual(layout, sample, &numbers));
    cost.SetNumResiduals(kChannels);
    using Block = Eigen::Matrix<double, kChannels, Eigen::Dynamic, Eigen::RowMajor>;
    std::vector<Block> blocks;
    std::vector<const double*> values;
    std::vector<double*> derivatives;
    for (const int b : numbers) {
      const auto size = static_cast<int>(layout.block(b).size());
      cost.AddParameterBlock(size);
      values.push_back(layout.block(b).data());
      blocks.emplace_back(kChannels, size);
    }
    for (Block& block : blocks) derivatives.push_back(block.data());
    EXPECT_TRUE(cost.Evaluate(values.data(), at.r.data() + row, derivatives.data()));
    for (size_t b = 0; b < blocks.size(); ++b) {
      const std::span<const int> columns = layout.parameters(numbers[b]);
      for (size_t k = 0; k < columns.size(); ++k) {
        at.J.block<kChannels, 1>(row, columns[k]) = blocks[b].col(static_cast<Eigen::Index>(k));
      }
    }
    row += kChannels;
  }
  return at;
}

// The s that minimises |r + J s|^2 + lambda |s|^2: never squares the condition of J.
VectorXd StepByQr(const MatrixXd& J, const VectorXd& r, double lambda) {
  const Eigen::Index n = J.cols();
  MatrixXd A(J.rows() + n, n);
  A << J, std::sqrt(lambda) * MatrixXd::Identity(n, n);
  VectorXd b = VectorXd::Zero(A.rows());
  b.head(J.rows()) = -r;
  return A.colPivHouseholderQr().solve(b);
}

// The same from H = J'J and g = J'r.
VectorXd StepByCholesky(MatrixXd H, const VectorXd& g, double lambda) {
  const auto n = static_cast<int>(g.size());
  H.diagonal().array() += lambda;
  VectorXd s = -g;
  EXPECT_TRUE(FactorCholesky(n, H.data()));
  SolveLower(n, H.data(), 1, s.data());
  SolveLowerTransposed(n, H.data(), s.data());
  return s;
}

// J'J of unit columns and J'r are off by roundings, which add up to eps times the root of the
// number of columns: a step, by that over lambda, however large the condition.
TEST(SquaredCondition, ErrorOfStepsIsThatOfRoundingOverLambda) {
  std::cout << "lobes' difference   cond(J)   lambda   error of the step   of its decrease of E\n"
            << std::scientific << std::setprecision(1);
  double largest_condition = 0;
  for (int exponent = 1; exponent <= 7; ++exponent) {
    const FactorModel model = NearlyEqualLobes(std::pow(10, -exponent));
    const Objective objective = NoisyObjective(model);
    const Linearization at = Linearize(objective, model);
    QuadraticModel equations;
    NormalEquations(objective).Evaluate(model, Hessian::kGaussNewton, &equations);
    const Eigen::Index n = at.J.cols();
    const VectorXd scale = at.J.colwise().norm().cwiseInverse();
    const MatrixXd J = at.J * scale.asDiagonal();
    const MatrixXd H = scale.asDiagonal() * Eigen::Map<const MatrixXd>(equations.H.data(), n, n) *
                       scale.asDiagonal();
    const VectorXd g = scale.cwiseProduct(Eigen::Map<const VectorXd>(equations.gradient.data(), n));
    const double E = at.r.squaredNorm();
    EXPECT_NEAR(equations.objective, E, 1e-12 * E);
    EXPECT_LT((g - J.transpose() * at.r).cwiseAbs().maxCoeff(), 1e-12 * std::sqrt(E));
    EXPECT_LT((H - J.transpose() * J).cwiseAbs().maxCoeff(), 1e-12);

    const VectorXd singular = Eigen::JacobiSVD<MatrixXd>(J).singularValues();
    const double condition = singular(0) / singular(n - 1 - kGaugeDimensions);
    largest_condition = std::max(largest_condition, condition);
    for (const double lambda : {1e-12, 1e-10, 1e-8, 1e-6, 1e-4}) {
      const VectorXd expected = StepByQr(J, at.r, lambda);
      const VectorXd actual = StepByCholesky(H, g, lambda);
      const double error = (actual - expected).norm() / expected.norm();
      const double decrease = E - (at.r + J * expected).squaredNorm();
      const double predicted = -2 * g.dot(actual) - actual.dot(H * actual);
      const double decrease_error = std::abs(predicted / decrease - 1);
      std::cout << std::setw(17) << std::pow(10, -exponent) << std::setw(10) << condition
                << std::setw(9) << lambda << std::setw(20) << error << std::setw(23)
                << decrease_error << "\n";
      const double tolerance = std::numeric_limits<double>::epsilon() * std::sqrt(n) / lambda;
      EXPECT_LT(error, std::min(1e-3, tolerance));
      EXPECT_LT(decrease_error, std::min(1e-4, tolerance));
    }
  }
  EXPECT_GT(largest_condition, 1e12);
}

TEST(SquaredCondition, IsWarnedOfWhereItIsTooLarge) {
  const auto diagnosed = [](double difference) {
    FactorModel model = NearlyEqualLobes(difference);
    return MakeSolver("newton")->Solve(NoisyObjective(model), {.max_iterations = 0}, &model);
  };
  const SolverSummary good = diagnosed(0.3);
  ASSERT_TRUE(good.diagnosis);
  EXPECT_EQ(good.diagnosis->unresolved, 0);
  EXPECT_EQ(good.diagnosis->rank + kGaugeDimensions, good.diagnosis->observed_parameters);
  EXPECT_THAT(good.notes, testing::IsEmpty());

  const SolverSummary near = diagnosed(0.02);
  EXPECT_EQ(near.diagnosis->unresolved, 0);
  EXPECT_GT(near.diagnosis->condition, 0.1 / near.diagnosis->rank_tolerance);
  EXPECT_THAT(near.notes,
              testing::ElementsAre(testing::HasSubstr("J's condition number, 1.9e+06")));

  // Lost directions no longer show in the condition number of those that are left.
  const SolverSummary lost = diagnosed(1e-3);
  EXPECT_GT(lost.diagnosis->unresolved, 0);
  EXPECT_LT(lost.diagnosis->condition, 0.1 / lost.diagnosis->rank_tolerance);
  EXPECT_THAT(lost.notes, testing::ElementsAre(testing::HasSubstr("of the fit's directions")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
