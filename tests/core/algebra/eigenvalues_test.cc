#include "core/algebra/eigenvalues.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <vector>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

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
