#include "trilobe/math/cholesky.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/base/parallel.h"

namespace trilobe {
namespace {

// B B' + 1, whose size is on both sides of where tiles begin, and no multiple of theirs.
std::vector<double> PositiveDefinite(int n) {
  Random random(1);
  Eigen::MatrixXd B(n, 20);
  for (double& x : B.reshaped()) x = random.Normal();
  const Eigen::MatrixXd A = B * B.transpose() + Eigen::MatrixXd::Identity(n, n);
  return {A.data(), A.data() + A.size()};
}

TEST(FactorCholesky, MultipliesBackToTheMatrix) {
  for (const int n : {1, 7, 300, 1025, 1300}) {
    const std::vector<double> A = PositiveDefinite(n);
    std::vector<double> factor = A;
    ASSERT_TRUE(FactorCholesky(n, factor.data(), 2));
    const Eigen::Map<const Eigen::MatrixXd> L(factor.data(), n, n), wanted(A.data(), n, n);
    // By the products with a vector, in which each entry has its part.
    Random random(2);
    Eigen::VectorXd x(n);
    for (double& number : x) number = random.Normal();
    const Eigen::VectorXd half = L.triangularView<Eigen::Lower>().transpose() * x;
    const Eigen::VectorXd product = L.triangularView<Eigen::Lower>() * half;
    EXPECT_LT((product - wanted * x).cwiseAbs().maxCoeff(), 1e-12 * wanted.cwiseAbs().maxCoeff())
        << n;
  }
}

TEST(FactorCholesky, HasTheSameBitsForAnyNumberOfThreads) {
  const int n = 1300;
  std::vector<double> first = PositiveDefinite(n), second = first, third = first;
  ASSERT_TRUE(FactorCholesky(n, first.data(), 1));
  ASSERT_TRUE(FactorCholesky(n, second.data(), 2));
  ASSERT_TRUE(FactorCholesky(n, third.data(), 3));
  EXPECT_TRUE(std::ranges::equal(first, second));
  EXPECT_TRUE(std::ranges::equal(first, third));
}

// OpenBLAS without threads got one call of two hundred wrong.
TEST(FactorCholesky, MayBeCalledFromSeveralThreads) {
  const int n = 200, repetitions = 1000;
  const std::vector<double> A = PositiveDefinite(n);
  std::vector<double> wanted = A;
  ASSERT_TRUE(FactorCholesky(n, wanted.data()));
  std::vector<int> wrong(4, 0);
  ParallelFor(4, 4, [&](int thread) {
    for (int k = 0; k < repetitions; ++k) {
      std::vector<double> factor = A;
      if (!FactorCholesky(n, factor.data()) || factor != wanted) ++wrong[thread];
    }
  });
  EXPECT_THAT(wrong, testing::Each(0));
}

TEST(FactorCholesky, TellsAMatrixThatIsNotPositiveDefinite) {
  for (const int n : {20, 1300}) {
    std::vector<double> A = PositiveDefinite(n);
    A[static_cast<size_t>(n - 1) * n + n - 1] = -1;
    EXPECT_FALSE(FactorCholesky(n, A.data(), 2));
  }
}

}  // namespace
}  // namespace trilobe
