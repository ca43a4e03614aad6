#include "fit/prune/tableau.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <vector>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr int kSize = 60;

// A quadratic (z - z0)' A (z - z0), and where it is lowest under C z = 0 and with some of z held at
// 0, by the equations of Lagrange's multipliers: what the tableau updates step by step.
struct Quadratic {
  Eigen::MatrixXd A;
  Eigen::VectorXd z0;
  std::vector<Constraint> constraints;
  std::vector<int> held;

  Quadratic() : A(kSize, kSize), z0(kSize) {
    Random random(3);
    Eigen::MatrixXd B(kSize, kSize);
    for (double& x : B.reshaped()) x = random.Normal();
    A = B * B.transpose() / kSize + Eigen::MatrixXd::Identity(kSize, kSize);
    for (double& x : z0) x = 1 + random.Normal();
  }

  Eigen::VectorXd Lowest() const {
    const auto rows = static_cast<int>(constraints.size() + held.size());
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(kSize + rows, kSize + rows);
    K.topLeftCorner(kSize, kSize) = A;
    int row = kSize;
    for (const Constraint& c : constraints) {
      for (const Term& term : c) K(row, term.row) = K(term.row, row) = term.factor;
      ++row;
    }
    for (const int k : held) {
      K(row, k) = K(k, row) = 1;
      ++row;
    }
    Eigen::VectorXd b = Eigen::VectorXd::Zero(kSize + rows);
    b.head(kSize) = A * z0;
    return K.fullPivLu().solve(b).head(kSize);
  }
  double Rise() const {
    const Eigen::VectorXd away = Lowest() - z0;
    return away.dot(A * away);
  }
};

Tableau MakeTableau(const Quadratic& q) {
  return {{q.A.data(), q.A.data() + q.A.size()}, {q.z0.begin(), q.z0.end()}};
}

// z_k is the mean of its neighbours.
Constraint MeanOfNeighbours(int k) {
  Constraint c;
  c.Add(k, 1);
  c.Add(k - 1, -0.5);
  c.Add(k + 1, -0.5);
  return c;
}

// So many that changes have to wait, and wait no longer, more than once.
TEST(Tableau, ImposesAndHoldsAsTheEquationsDo) {
  Quadratic q;
  Tableau tableau = MakeTableau(q);
  ASSERT_TRUE(tableau.valid());
  double rise = 0;
  for (int k = 1; k + 1 < kSize; k += 3) {
    const Constraint c = MeanOfNeighbours(k);
    const double by_it = tableau.Rise(c);
    tableau.Impose(c);
    rise += by_it;
    q.constraints.push_back(c);
    if (k % 2 == 0) {
      rise += tableau.Pivot(k + 1);
      q.held.push_back(k + 1);
    }
    EXPECT_NEAR(rise, q.Rise(), 1e-9 * rise) << k;
  }
  const Eigen::VectorXd lowest = q.Lowest();
  for (int k = 0; k < kSize; ++k) {
    if (!tableau.free(k)) continue;
    EXPECT_NEAR(tableau.h(k), lowest[k], 1e-9) << k;
  }
  // Let go again, the last first.
  while (!q.held.empty()) {
    rise += tableau.Pivot(q.held.back());
    q.held.pop_back();
    EXPECT_NEAR(rise, q.Rise(), 1e-9 * rise);
  }
}

TEST(Tableau, TheLastTakesThePlaceOfWhatIsRemoved) {
  Quadratic q;
  Tableau tableau = MakeTableau(q);
  for (int k = 1; k < 19; k += 3) {
    const Constraint c = MeanOfNeighbours(k);
    tableau.Impose(c);
    q.constraints.push_back(c);
  }
  const Eigen::VectorXd lowest = q.Lowest();
  tableau.Remove(4);
  ASSERT_EQ(tableau.size(), kSize - 1);
  EXPECT_NEAR(tableau.h(4), lowest[kSize - 1], 1e-9);
  // Of the last one, under its new name, and of two others.
  Constraint renamed, named;
  for (const int k : {30, 40}) {
    renamed.Add(k, 1);
    named.Add(k, 1);
  }
  renamed.Add(4, -2);
  named.Add(kSize - 1, -2);
  const double before = q.Rise();
  q.constraints.push_back(named);
  EXPECT_NEAR(tableau.Rise(renamed), q.Rise() - before, 1e-9 * before);
}

TEST(Tableau, OfAMatrixThatIsNotPositiveDefiniteIsOfNoUse) {
  EXPECT_FALSE(Tableau({1, 2, 2, 1}, {1, 1}).valid());
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
