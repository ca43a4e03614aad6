#include "trilobe/solvers/joint/nonnegative_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "tests/test_util.h"

namespace trilobe {
namespace {

constexpr size_t kSize = 60;

// B'B + 0.1 around a point that is at its bounds every third time, with a gradient of any sign.
struct Case {
  QuadraticModel at;
  std::vector<double> x = std::vector<double>(kSize), metric = std::vector<double>(kSize);

  explicit Case(uint64_t seed) {
    Random random(seed);
    std::vector<double> B(kSize * kSize);
    for (double& b : B) b = random.Normal();
    at.H.resize(kSize * kSize);
    for (size_t k = 0; k < kSize; ++k) {
      for (size_t l = 0; l < kSize; ++l) {
        at.H[k * kSize + l] = k == l ? 0.1 : 0;
        for (size_t i = 0; i < kSize; ++i)
          at.H[k * kSize + l] += B[i * kSize + k] * B[i * kSize + l];
      }
      at.gradient.push_back(random.Normal());
      x[k] = k % 3 == 0 ? 0 : 0.1 * random.LogNormal(1);
      metric[k] = random.LogNormal(1);
    }
  }
};

TEST(NonnegativeStep, EndsWhereNothingWantsToMove) {
  constexpr double kLambda = 0.3;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Case of(seed);
    NonnegativeStep step;
    step.MoveTo(of.at, of.metric, of.x);
    const NonnegativeStep::Result result = step.Solve(kLambda);
    EXPECT_GT(result.predicted_decrease, 0);
    int bound = 0;
    for (size_t k = 0; k < kSize; ++k) {
      double slope =
          of.at.gradient[k] + kLambda * of.metric[k] * of.metric[k] * (result.x[k] - of.x[k]);
      for (size_t l = 0; l < kSize; ++l) {
        slope += of.at.H[k * kSize + l] * (result.x[l] - of.x[l]);
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

TEST(NonnegativeStep, TakesTheSameStepInAnyOrderOfElimination) {
  std::vector<size_t> order(kSize);
  std::iota(order.rbegin(), order.rend(), 0);
  std::rotate(order.begin(), order.begin() + 7, order.end());
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Case of(seed);
    NonnegativeStep as_they_come, ordered(1, order);
    as_they_come.MoveTo(of.at, of.metric, of.x);
    ordered.MoveTo(of.at, of.metric, of.x);
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
}  // namespace trilobe
