#include "solvers/joint/nonnegative_step.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <vector>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// B B' + 0.1 around a point that is at its bounds every third time, with a gradient of any sign.
struct Case {
  size_t size;
  QuadraticModel at;
  std::vector<double> x, metric;

  Case(uint64_t seed, size_t number) : size(number), x(number), metric(number) {
    Random random(seed);
    Eigen::MatrixXd B(size, size);
    for (double& b : B.reshaped()) b = random.Normal();
    const Eigen::MatrixXd H = B * B.transpose() + 0.1 * Eigen::MatrixXd::Identity(size, size);
    at.H.assign(H.data(), H.data() + H.size());
    for (size_t k = 0; k < size; ++k) {
      at.gradient.push_back(random.Normal());
      x[k] = k % 3 == 0 ? 0 : 0.1 * random.LogNormal(1);
      metric[k] = random.LogNormal(1);
    }
  }
};

// These seeds need few rounds. Of 300 parameters 25 may change sides under one factor.
TEST(NonnegativeStep, EndsWhereNothingWantsToMove) {
  constexpr double kLambda = 0.3;
  for (uint64_t seed = 1; seed <= 7; ++seed) {
    const Case problem(seed, seed <= 5 ? 60 : 300);
    NonnegativeStep step;
    step.MoveTo(problem.at, problem.metric, problem.x);
    const NonnegativeStep::Result result = step.Solve(kLambda);
    EXPECT_GT(result.predicted_decrease, 0);
    int bound = 0;
    for (size_t k = 0; k < problem.size; ++k) {
      double slope = problem.at.gradient[k] +
                     kLambda * problem.metric[k] * problem.metric[k] * (result.x[k] - problem.x[k]);
      for (size_t l = 0; l < problem.size; ++l) {
        slope += problem.at.H[k * problem.size + l] * (result.x[l] - problem.x[l]);
      }
      if (result.x[k] > 0) {
        EXPECT_NEAR(slope, 0, 1e-9) << "seed " << seed << ", " << k;
      } else {
        EXPECT_GE(slope, -1e-9) << "seed " << seed << ", " << k;
        ++bound;
      }
    }
    EXPECT_GT(bound, 5) << "seed " << seed;
  }
}

TEST(NonnegativeStep, SameBitsForAnyNumberOfThreads) {
  const Case problem(1, 300);
  NonnegativeStep one(1);
  one.MoveTo(problem.at, problem.metric, problem.x);
  const NonnegativeStep::Result wanted = one.Solve(0.1);
  for (const int threads : {2, 3}) {
    NonnegativeStep step(threads);
    step.MoveTo(problem.at, problem.metric, problem.x);
    const NonnegativeStep::Result is = step.Solve(0.1);
    EXPECT_EQ(is.x, wanted.x);
    EXPECT_EQ(is.predicted_decrease, wanted.predicted_decrease);
  }
}

TEST(NonnegativeStep, TakesTheSameStepInAnyOrderOfElimination) {
  constexpr size_t kSize = 60;
  std::vector<size_t> order(kSize);
  std::iota(order.rbegin(), order.rend(), 0);
  std::rotate(order.begin(), order.begin() + 7, order.end());
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Case problem(seed, kSize);
    NonnegativeStep as_they_come, ordered(1, order);
    as_they_come.MoveTo(problem.at, problem.metric, problem.x);
    ordered.MoveTo(problem.at, problem.metric, problem.x);
    for (const double lambda : {1.0, 0.01}) {
      const NonnegativeStep::Result wanted = as_they_come.Solve(lambda), is = ordered.Solve(lambda);
      for (size_t k = 0; k < kSize; ++k) {
        EXPECT_NEAR(is.x[k], wanted.x[k], 1e-9) << "seed " << seed << ", " << k;
      }
      EXPECT_NEAR(is.predicted_decrease, wanted.predicted_decrease,
                  1e-9 * wanted.predicted_decrease);
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
