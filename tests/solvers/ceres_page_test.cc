// Runs the first program of docs/ceres.md, which CMake cuts out of the page.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"
#include "trilobe/solvers/sums/normal_equations.h"

// Defined in the program of the page.
trilobe::FactorModel FitSmoothF(const trilobe::Objective& objective, double weight,
                                trilobe::FactorModel* model);

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 12, .theta_d = 10, .phi_d = 16};

BrdfSamples Copper() {
  return SamplesOf(LoadMeasurement("synth:copper@12x10x16", {.noise = 0.02}));
}

Objective ObjectiveOf(const BrdfSamples& samples) {
  return {samples, ModelSpec::SharedFactors(1, kGrid), FindWeighting("percentage")};
}

FactorModel Start(const Objective& objective) {
  return FindInitialModel("analytic").make(objective, /*seed=*/1);
}

// F[k - 1] - 2 F[k] + F[k + 1] of each table, by rows.
Eigen::MatrixXd Bends(const FactorModel& layout) {
  const int inner = layout.spec().f_axis.size - 2;
  Eigen::MatrixXd bends =
      Eigen::MatrixXd::Zero(Eigen::Index{kChannels} * inner, layout.spec().num_parameters());
  for (int t = 0; t < kChannels; ++t) {
    for (int k = 0; k < inner; ++k) {
      const int first = layout.TableOffset(Factor::kF, t) + k;
      bends.row(t * inner + k).segment(first, 3) = Eigen::RowVector3d(1, -2, 1);
    }
  }
  return bends;
}

TEST(CeresPage, EndsWhereLmDoesWithoutThePrior) {
  const Objective objective = ObjectiveOf(Copper());
  FactorModel model = Start(objective), by_lm = model;
  MakeSolver("lm")->Solve(objective, {.max_iterations = 100}, &by_lm);
  const double E = objective.Value(by_lm);
  FitSmoothF(objective, 0, &model);
  EXPECT_NEAR(objective.Value(model), E, 1e-6 * E);

  const Eigen::MatrixXd bends = Bends(model);
  const auto roughness = [&](const FactorModel& of) {
    const auto x = Eigen::VectorXd::Map(of.parameters().data(), bends.cols());
    return (bends * x).squaredNorm();
  };
  FactorModel smooth = Start(objective);
  FitSmoothF(objective, 1, &smooth);
  EXPECT_LT(roughness(smooth), 0.5 * roughness(model));
  EXPECT_GT(objective.Value(smooth), E);
}

// Ceres stops higher by bounds alone.
TEST(CeresPage, EndsWhereLmDoesThoughParametersEndAtZero) {
  const Measurement plastic = LoadMeasurement("synth:plastic@12x10x16", {.noise = 0.03});
  const Objective objective(SamplesOf(plastic), ModelSpec::SharedFactors(1, kGrid),
                            FindWeighting("appearance"));
  FactorModel model = Start(objective), by_lm = model, by_bounds = model;
  MakeSolver("lm")->Solve(objective, {.max_iterations = 300}, &by_lm);
  MakeSolver("lm")->Solve(objective, {.max_iterations = 300, .positivity = Positivity::kBounds},
                          &by_bounds);
  const double E = objective.Value(by_lm);
  EXPECT_GT(objective.Value(by_bounds), 1.02 * E);
  const FactorModel deviations = FitSmoothF(objective, 0, &model);
  EXPECT_LT(objective.Value(model), 1.0001 * E);
  int held = 0;
  for (size_t k = 0; k < model.parameters().size(); ++k) {
    if (model.parameters()[k] == 0) {
      EXPECT_EQ(deviations.parameters()[k], 0) << k;
      ++held;
    }
  }
  EXPECT_GT(held, 0);
}

// (J'J)^-1 of what is free by a dense factorisation, of equations that the library adds up.
TEST(CeresPage, StandardDeviationsAreThoseOfADenseInverse) {
  const Objective objective = ObjectiveOf(Copper());
  for (const double weight : {0.0, 0.1}) {
    FactorModel model = Start(objective);
    const FactorModel deviations = FitSmoothF(objective, weight, &model);
    std::vector<int> free;
    for (int k = 0; k < model.spec().num_parameters(); ++k) {
      if (deviations.parameters()[k] > 0) free.push_back(k);
    }
    // The gauge is held in one entry of D and of G, and in three of F.
    ASSERT_EQ(free.size(), model.parameters().size() - 5);

    QuadraticModel at;
    NormalEquations(objective).Evaluate(model, Hessian::kGaussNewton, &at);
    const Eigen::Index n = model.spec().num_parameters();
    const Eigen::MatrixXd bends = weight * Bends(model);
    const auto x = Eigen::VectorXd::Map(model.parameters().data(), n);
    const Eigen::MatrixXd JtJ = Eigen::MatrixXd::Map(at.H.data(), n, n) + bends.transpose() * bends;
    const Eigen::MatrixXd of_free = JtJ(free, free);
    const Eigen::VectorXd scale = of_free.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd inverse =
        Eigen::MatrixXd(scale.asDiagonal() * of_free * scale.asDiagonal()).inverse();
    const double residuals = static_cast<double>(kChannels * objective.samples().size() +
                                                 bends.rows() - static_cast<int>(free.size()));
    const double sigma2 = (objective.Value(model) + (bends * x).squaredNorm()) / residuals;
    for (size_t k = 0; k < free.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const double expected = scale(i) * std::sqrt(sigma2 * inverse(i, i));
      EXPECT_NEAR(deviations.parameters()[free[k]], expected, 1e-6 * expected) << free[k];
    }
  }
}

// Fits of a material of the model's own form, each with noise of its own.
TEST(CeresPage, RefitsSpreadAsTheStandardDeviationsSay) {
  BrdfSamples samples = Copper();
  FactorModel truth = Start(ObjectiveOf(samples));
  FitSmoothF(ObjectiveOf(samples), 0, &truth);
  constexpr double kNoise = 0.02;
  const int n = truth.spec().num_parameters(), refits = kSanitized ? 5 : 15;
  std::vector<double> squares(n, 0.0), deviations;
  for (int refit = 0; refit < refits; ++refit) {
    Random random(refit + 1);
    for (int j = 0; j < samples.size(); ++j) {
      const SampleStencils at = GridStencils(truth.spec(), kGrid, samples.bins[j]);
      for (int c = 0; c < kChannels; ++c) {
        samples.rho[j][c] = UnclampedValue(truth, at, c) * random.LogNormal(kNoise);
      }
    }
    FactorModel model = truth;
    const FactorModel of_model = FitSmoothF(ObjectiveOf(samples), 0, &model);
    deviations.assign(of_model.parameters().begin(), of_model.parameters().end());
    for (int k = 0; k < n; ++k) {
      squares[k] += std::pow(model.parameters()[k] - truth.parameters()[k], 2) / refits;
    }
  }
  std::vector<double> ratios;
  for (int k = 0; k < n; ++k) {
    if (deviations[k] > 0) ratios.push_back(std::sqrt(squares[k]) / deviations[k]);
  }
  std::ranges::sort(ratios);
  // A spread over 15 refits is itself known to a fifth.
  EXPECT_NEAR(ratios[ratios.size() / 2], 1, kSanitized ? 0.4 : 0.2);
  EXPECT_LT(ratios.back(), 2.5);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
