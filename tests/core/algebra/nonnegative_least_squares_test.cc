#include "core/algebra/nonnegative_least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/algebra/element_step.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kPenalty = 0x1p-30;

using Eigen::MatrixXd;
using Eigen::VectorXd;

// H = B'B with rows of B random, and x >= 0, some of it 0.
struct Problem {
  MatrixXd H;
  VectorXd g;
  VectorXd x;
  double E = 0;

  double Change(const VectorXd& end) const {
    const VectorXd delta = end - x;
    return delta.dot(H * delta) - 2 * g.dot(delta);
  }
  VectorXd Solve() const {
    const Eigen::Index n = x.size();
    std::vector<double> values(x.data(), x.data() + n);
    SolveNonnegativeLeastSquares({H.data(), static_cast<size_t>(H.size())},
                                 {g.data(), static_cast<size_t>(n)}, E, values);
    return Eigen::Map<const VectorXd>(values.data(), n);
  }
};

Problem RandomProblem(int n, int rank, uint64_t seed) {
  Random random(seed);
  MatrixXd B(rank, n);
  VectorXd r(rank);
  for (int i = 0; i < rank; ++i) {
    r[i] = random.Normal();
    for (int k = 0; k < n; ++k) B(i, k) = random.Normal();
  }
  Problem problem{B.transpose() * B, B.transpose() * r, VectorXd(n)};
  for (int k = 0; k < n; ++k) {
    problem.x[k] = random.Uniform() < 0.4 ? 0 : random.LogNormal(1);
  }
  return problem;
}

// The lowest value over all choices of which unknowns are 0.
double BruteForce(const Problem& problem) {
  const int n = static_cast<int>(problem.x.size());
  double best = 0;
  for (int zeros = 0; zeros < 1 << n; ++zeros) {
    std::vector<int> free;
    VectorXd solution = VectorXd::Zero(n);
    for (int k = 0; k < n; ++k) {
      if (!(zeros >> k & 1)) free.push_back(k);
    }
    const VectorXd rhs = problem.g + problem.H * problem.x;
    if (!free.empty()) {
      const MatrixXd H = problem.H(free, free);
      const VectorXd rhs_free = rhs(free);
      const VectorXd x_free = H.ldlt().solve(rhs_free);
      solution(free) = x_free;
    }
    if (solution.minCoeff() >= 0) best = std::min(best, problem.Change(solution));
  }
  return best;
}

// The penalty of 2^-30 moves the minimum by that fraction of |delta|^2, in units in which the
// diagonal of H is 1.
double Tolerance(const Problem& problem, const VectorXd& solution) {
  const double penalty = problem.H.diagonal().dot((solution - problem.x).cwiseAbs2());
  const double size = problem.g.cwiseAbs().dot((solution - problem.x).cwiseAbs());
  return kPenalty * penalty + 1e-13 * (size + penalty);
}

TEST(NonnegativeLeastSquares, FindsTheLowestOfAllActiveSets) {
  for (int n = 2; n <= kMaxNonnegativeUnknowns; ++n) {
    for (uint64_t seed = 1; seed <= (n > 6 ? 5 : 50); ++seed) {
      const Problem problem = RandomProblem(n, n + 2, seed);
      const VectorXd solution = problem.Solve();
      EXPECT_GE(solution.minCoeff(), 0);
      EXPECT_NEAR(problem.Change(solution), BruteForce(problem), Tolerance(problem, solution))
          << n << " unknowns, seed " << seed;
    }
  }
}

// A singular H has many minima on a face, of which some may have negative entries and others none:
// a case for the conditions of optimality, not for brute force.
TEST(NonnegativeLeastSquares, IsOptimalWhereHIsSingular) {
  for (int n = 2; n <= kMaxNonnegativeUnknowns; ++n) {
    for (int rank = 1; rank < n; ++rank) {
      for (uint64_t seed = 1; seed <= 10; ++seed) {
        const Problem problem = RandomProblem(n, rank, seed);
        const VectorXd solution = problem.Solve();
        const VectorXd descent = problem.g - problem.H * (solution - problem.x);
        const double scale = problem.g.cwiseAbs().maxCoeff() +
                             problem.H.cwiseAbs().maxCoeff() * (solution - problem.x).lpNorm<1>();
        for (int k = 0; k < n; ++k) {
          ASSERT_GE(solution[k], 0);
          EXPECT_LE(descent[k], 2 * kPenalty * scale)
              << n << ", rank " << rank << ", seed " << seed;
          if (solution[k] > 0) {
            EXPECT_GE(descent[k], -2 * kPenalty * scale)
                << n << ", rank " << rank << ", seed " << seed;
          }
        }
        EXPECT_LE(problem.Change(solution), 0);
      }
    }
  }
}

TEST(NonnegativeLeastSquares, StaysAtAMinimum) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    Problem problem = RandomProblem(4, 6, seed);
    const VectorXd solution = problem.Solve();
    const double tolerance = Tolerance(problem, solution);
    problem.g -= problem.H * (solution - problem.x);
    problem.x = solution;
    EXPECT_NEAR(problem.Change(problem.Solve()), 0, tolerance) << "seed " << seed;
  }
}

// Two equal columns: what one takes the other loses, and neither is asked to.
TEST(NonnegativeLeastSquares, StaysInFlatDirections) {
  Problem problem{MatrixXd::Constant(2, 2, 3), VectorXd::Constant(2, 6), VectorXd(2)};
  problem.x << 5, 1;
  const VectorXd solution = problem.Solve();
  constexpr double kTolerance =
      4 * kEpsilon / kPenalty * 6 / 3;  // rounding of g / 3, by the penalty
  EXPECT_NEAR(solution[0], 6, kTolerance);
  EXPECT_NEAR(solution[1], 2, kTolerance);
  EXPECT_NEAR(solution.sum(), 8, 4 * kPenalty);
}

// Rounding errors of g that are out of H's range look like a decrease of 2^30 times their square;
// without E they would move x by 2^30 times themselves.
TEST(NonnegativeLeastSquares, DoesNotFollowRoundingErrors) {
  Problem problem{MatrixXd::Ones(2, 2), VectorXd(2), VectorXd::Ones(2)};
  problem.g << kEpsilon, -kEpsilon;
  EXPECT_GT((problem.Solve() - problem.x).norm(), 1e6 * kEpsilon);
  problem.E = 1;
  EXPECT_LE((problem.Solve() - problem.x).norm(), 4 * kEpsilon);
}

TEST(NonnegativeLeastSquares, HoldsWhatEDoesNotDependOn) {
  Problem problem{MatrixXd::Zero(3, 3), VectorXd::Zero(3), VectorXd(3)};
  problem.x << 0, 1, 2;
  EXPECT_EQ(problem.Solve(), problem.x);
  problem.H(1, 1) = 2;
  problem.g[1] = 4;
  VectorXd expected(3);
  expected << 0, 3, 2;
  EXPECT_TRUE(problem.Solve().isApprox(expected, kPenalty));
}

TEST(NonnegativeLeastSquares, DoesNotDependOnUnits) {
  const Problem problem = RandomProblem(5, 5, 1);
  const VectorXd solution = problem.Solve();
  VectorXd units(5);
  units << 0x1p100, 1, 0x1p-100, 0x1p7, 0x1p-3;
  const VectorXd inverse = units.cwiseInverse();
  const Problem scaled{inverse.asDiagonal() * problem.H * inverse.asDiagonal(),
                       inverse.cwiseProduct(problem.g), units.cwiseProduct(problem.x)};
  EXPECT_EQ(scaled.Solve(), units.cwiseProduct(solution));
}

// Nothing here is a number or small enough for a model; what comes back is.
TEST(NonnegativeLeastSquares, SurvivesWhatIsNoNumber) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {kInfinity, -kInfinity, std::nan(""), 1e300}) {
    for (const double diagonal : {1e-300, 1.0, bad}) {
      Problem problem{MatrixXd::Identity(3, 3), VectorXd::Ones(3), VectorXd::Ones(3)};
      problem.g[1] = bad;
      problem.H(0, 0) = diagonal;
      problem.H(0, 1) = problem.H(1, 0) = bad;
      const VectorXd solution = problem.Solve();
      EXPECT_TRUE(solution.allFinite()) << bad << ", " << diagonal;
      EXPECT_GE(solution.minCoeff(), 0);
      EXPECT_LE(solution.maxCoeff(), kMaxParameter);
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
