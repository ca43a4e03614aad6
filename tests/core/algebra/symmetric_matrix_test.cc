#include "core/algebra/symmetric_matrix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// B B' + 1, whose size is on both sides of where tiles begin, and no multiple of theirs.
std::vector<double> PositiveDefinite(int n) {
  Random random(1);
  Eigen::MatrixXd B(n, 20);
  for (double& x : B.reshaped()) x = random.Normal();
  const Eigen::MatrixXd A = B * B.transpose() + Eigen::MatrixXd::Identity(n, n);
  return {A.data(), A.data() + A.size()};
}

// The same, but the first of its rows have products with their neighbours alone, those of the first
// with those of the last, and with all of the others: a ring of nodes and what all of them share.
std::vector<double> RingAndBorder(int n, int border, int reach) {
  std::vector<double> A = PositiveDefinite(n);
  const int ring = n - border;
  for (int i = 0; i < ring; ++i) {
    for (int j = 0; j < ring; ++j) {
      const int apart = std::min(std::abs(i - j), ring - std::abs(i - j));
      if (apart > reach) A[static_cast<size_t>(i) * n + j] = 0;
    }
    A[static_cast<size_t>(i) * n + i] += n;  // positive definite without them, too
  }
  return A;
}

// Compares products with a random vector, to which every entry contributes.
void ExpectMultipliesBack(int n, const std::vector<double>& A) {
  std::vector<double> factor = A;
  ASSERT_TRUE(FactorCholesky(n, factor.data(), 2));
  const Eigen::Map<const Eigen::MatrixXd> L(factor.data(), n, n), wanted(A.data(), n, n);
  Random random(2);
  Eigen::VectorXd x(n);
  for (double& number : x) number = random.Normal();
  const Eigen::VectorXd half = L.triangularView<Eigen::Lower>().transpose() * x;
  const Eigen::VectorXd product = L.triangularView<Eigen::Lower>() * half;
  EXPECT_LT((product - wanted * x).cwiseAbs().maxCoeff(), 1e-12 * wanted.cwiseAbs().maxCoeff())
      << n;
}

TEST(FactorCholesky, MultipliesBackToTheMatrix) {
  for (const int n : {1, 7, 300, 1025, 1300}) ExpectMultipliesBack(n, PositiveDefinite(n));
}

TEST(FactorCholesky, MultipliesBackToAMatrixWithTilesOfZeros) {
  for (const int n : {1025, 1300}) {
    ExpectMultipliesBack(n, RingAndBorder(n, /*border=*/200, /*reach=*/30));
    // A diagonal matrix has no coupled tiles.
    ExpectMultipliesBack(n, RingAndBorder(n, /*border=*/0, /*reach=*/0));
  }
}

TEST(FactorCholesky, HasTheSameBitsForAnyNumberOfThreads) {
  const int n = 1300;
  for (const std::vector<double>& A : {PositiveDefinite(n), RingAndBorder(n, 200, 30)}) {
    std::vector<double> first = A, second = A, third = A;
    ASSERT_TRUE(FactorCholesky(n, first.data(), 1));
    ASSERT_TRUE(FactorCholesky(n, second.data(), 2));
    ASSERT_TRUE(FactorCholesky(n, third.data(), 3));
    EXPECT_TRUE(std::ranges::equal(first, second));
    EXPECT_TRUE(std::ranges::equal(first, third));
  }
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
    for (const int row : {0, n / 2, n - 1}) {  // the rest is given up
      std::vector<double> A = PositiveDefinite(n);
      A[static_cast<size_t>(row) * n + row] = -1;
      EXPECT_FALSE(FactorCholesky(n, A.data(), 2)) << row;
    }
  }
}

TEST(SolveLower, LeavesOutRowsThatAre0) {
  const int n = 30, columns = 2, first = 11;
  std::vector<double> L = PositiveDefinite(n);
  ASSERT_TRUE(FactorCholesky(n, L.data()));
  std::vector<double> B(static_cast<size_t>(n) * columns, 0.0);
  for (int j = 0; j < columns; ++j) B[j * n + first + 3 * j] = 1 + j;
  std::vector<double> all = B;
  SolveLower(n, L.data(), columns, B.data(), first);
  SolveLower(n, L.data(), columns, all.data());
  EXPECT_THAT(B, testing::Pointwise(testing::DoubleNear(1e-14), all));
  EXPECT_NE(B[n - 1], 0);
}

TEST(SymmetricEigenvalues, AreThoseOfEigen) {
  for (const int n : {1, 2, 40, 300}) {
    Random random(1);
    Eigen::MatrixXd B(n, n);
    for (double& x : B.reshaped()) x = random.Normal();
    const Eigen::MatrixXd A = B + B.transpose();
    const Eigen::VectorXd wanted =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
    const std::vector<double> values = SymmetricEigenvalues(n, {A.data(), A.data() + A.size()});
    ASSERT_EQ(values.size(), static_cast<size_t>(n));
    for (int k = 0; k < n; ++k) {
      EXPECT_NEAR(values[k], wanted[k], 1e-14 * n * wanted.cwiseAbs().maxCoeff()) << n << " " << k;
    }
  }
}

TEST(SymmetricEigenvalues, AreOfTheLowerTriangleAndMayBeZeroOrNone) {
  EXPECT_TRUE(SymmetricEigenvalues(0, {}).empty());
  EXPECT_EQ(SymmetricEigenvalues(2, {0, 0, 0, 0}), (std::vector<double>{0, 0}));
  // (2 1; 1 2), column by column, and what is above the diagonal is not read.
  const std::vector<double> values = SymmetricEigenvalues(2, {2, 1, 77, 2});
  EXPECT_DOUBLE_EQ(values[0], 1);
  EXPECT_DOUBLE_EQ(values[1], 3);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
