#include "solvers/gaussian_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 5, .theta_d = 7, .phi_d = 8};

std::vector<double> Live(const ModelSpec& spec) {
  return std::vector<double>(spec.num_parameters(), 1.0);
}

TEST(GaussianFilter, PreservesConstants) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  for (const double sigma : {1e-3, 0.5, 1.0, 3.0, 100.0}) {
    FactorModel model = RandomModel(spec, 1);
    for (int m = 0; m < 2; ++m) std::ranges::fill(model.table(Factor::kG, m), 0.3 + m);
    SmoothG(sigma, Live(spec), &model);
    for (int m = 0; m < 2; ++m) {
      for (const double G : model.table(Factor::kG, m)) EXPECT_DOUBLE_EQ(G, 0.3 + m) << sigma;
    }
  }
}

TEST(GaussianFilter, ByHand) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  FactorModel model(spec);
  const std::vector<double> old = {1, 5, 2, 8, 3, 0, 4};
  std::ranges::copy(old, model.table(Factor::kG, 0).begin());
  SmoothG(1.0 / 3, Live(spec), &model);  // cut at one node; the neighbour's weight is exp(-9/2)
  const auto G = model.table(Factor::kG, 0);
  const double e = std::exp(-4.5);
  EXPECT_NEAR(G[0], (1 + 5 * e) / (1 + e), 1e-15);
  EXPECT_NEAR(G[3], (8 + (2 + 3) * e) / (1 + 2 * e), 1e-14);
  EXPECT_NEAR(G[6], (4 + 0 * e) / (1 + e), 1e-15);
}

TEST(GaussianFilter, IsLinear) {
  const ModelSpec spec = ModelSpec::IndependentG(kGrid);
  const FactorModel a = RandomModel(spec, 1), b = RandomModel(spec, 2);
  FactorModel smooth_a = a, smooth_b = b, sum(spec);
  for (int k = 0; k < spec.num_parameters(); ++k) {
    sum.parameters()[k] = 2 * a.parameters()[k] + 3 * b.parameters()[k];
  }
  for (FactorModel* const model : {&smooth_a, &smooth_b, &sum}) SmoothG(1, Live(spec), model);
  for (int k = 0; k < spec.num_parameters(); ++k) {
    EXPECT_NEAR(sum.parameters()[k], 2 * smooth_a.parameters()[k] + 3 * smooth_b.parameters()[k],
                1e-14 * sum.parameters()[k]);
  }
}

TEST(GaussianFilter, SmoothsGAlone) {
  const ModelSpec spec = ModelSpec::SharedFactors(3, kGrid);
  const FactorModel before = RandomModel(spec, 3);
  FactorModel after = before;
  SmoothG(1, Live(spec), &after);
  const int first_G = before.TableOffset(Factor::kG, 0);
  for (int k = 0; k < spec.num_parameters(); ++k) {
    EXPECT_EQ(after.parameters()[k] == before.parameters()[k], k < first_G) << k;
  }
  for (int m = 0; m < 3; ++m) {  // a mean stays between the extremes
    const auto [low, high] = std::ranges::minmax(before.table(Factor::kG, m));
    for (const double G : after.table(Factor::kG, m)) {
      EXPECT_GT(G, low);
      EXPECT_LT(G, high);
    }
  }
}

// Unobserved nodes are neither changed nor read.
TEST(GaussianFilter, SkipsUnobservedNodes) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  FactorModel model(spec);
  std::ranges::copy(std::vector<double>{1, 777, 2, 8, 777, 777, 4},
                    model.table(Factor::kG, 0).begin());
  std::vector<double> coverage = Live(spec);
  const int first = model.TableOffset(Factor::kG, 0);
  for (const int unobserved : {1, 4, 5}) coverage[first + unobserved] = 0;
  SmoothG(0.5, coverage, &model);  // cut at two nodes
  const auto G = model.table(Factor::kG, 0);
  const double e1 = std::exp(-2.0), e2 = std::exp(-8.0);
  EXPECT_NEAR(G[0], (1 + 2 * e2) / (1 + e2), 1e-15);
  EXPECT_NEAR(G[2], (2 + 8 * e1 + 1 * e2) / (1 + e1 + e2), 1e-14);
  EXPECT_NEAR(G[3], (8 + 2 * e1) / (1 + e1), 1e-14);
  EXPECT_EQ(G[6], 4);
  for (const int unobserved : {1, 4, 5}) EXPECT_EQ(G[unobserved], 777);
}

TEST(GaussianFilter, AnyWidth) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const FactorModel before = RandomModel(spec, 4);
  const auto old = before.table(Factor::kG, 0);
  double mean = 0;
  for (const double G : old) mean += G / kGrid.theta_d;
  for (const double huge : {1e9, 1e300, std::numeric_limits<double>::infinity()}) {
    FactorModel model = before;
    SmoothG(huge, Live(spec), &model);
    for (const double G : model.table(Factor::kG, 0)) EXPECT_NEAR(G, mean, 1e-14) << huge;
  }
  FactorModel model = before;
  SmoothG(1e-300, Live(spec), &model);
  for (int k = 0; k < kGrid.theta_d; ++k) EXPECT_EQ(model.table(Factor::kG, 0)[k], old[k]);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
