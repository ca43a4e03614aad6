#include "fit/prune/node_elimination.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "fit/prune/reduced_quadratic.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/reduction.h"
#include "tests/test_util.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};

// A fit of smooth data with little noise, to its minimum.
struct Fit {
  Fit() : objective(MakeObjective(Measured(), ModelSpec::SharedFactors(1, kGrid))) {
    model = InitialModels().front().make(objective, 1);
    MakeSolver("varpro")->Solve(
        objective, {.max_iterations = 100, .relative_decrease_tolerance = 1e-12, .diagnose = false},
        &model);
    NormalEquations(objective).Evaluate(model, Hessian::kGaussNewton, &at);
  }
  static BrdfTable Measured() {
    FactorModel material(ModelSpec::SharedFactors(1, kGrid));
    for (double& x : material.parameters()) x = 1;
    for (int k = 0; k < 8; ++k) {
      material.table(Factor::kD, 0)[k] = std::exp(-0.2 * k * k);
      for (int c = 0; c < kChannels; ++c) material.table(Factor::kF, c)[k] += 0.02 * c * k * k;
    }
    BrdfTable table = TableOf(material, kGrid);
    Random random(1);
    for (int bin = 0; bin < kGrid.size(); ++bin) {
      for (int c = 0; c < kChannels; ++c) {
        if (table.Value(c, bin) < 0) continue;
        table.SetValue(c, bin, table.Value(c, bin) * random.LogNormal(0.01));
      }
    }
    return table;
  }
  const Objective objective;
  FactorModel model;
  QuadraticModel at;
};

EliminationLimits NoLimits(int count) {
  return {.max_rise = std::numeric_limits<double>::infinity(), .max_count = count};
}

// E after a fit of the parameters that are left.
double Refitted(const Fit& fit, const TableLayout& layout) {
  const Reduction reduction(fit.model.spec(), layout);
  FactorModel start(fit.model.spec());
  std::ranges::copy(reduction.Expand(reduction.Restrict(fit.model.parameters())),
                    start.parameters().begin());
  PhaseSeconds phases;
  JointStepper stepper(fit.objective, JointStepper::Curvature::kByProgress,
                       JointStepper::Trial::kAsItIs, &phases, &reduction);
  stepper.Restart(start);
  for (int step = 0; step < 40 && !stepper.exhausted(); ++step) stepper.Step();
  return stepper.E();
}

// E is quadratic only near its minimum, and J'J leaves out what residuals add to its curvature:
// 1 % noise here, and steps that are small since the nodes that go first matter least.
TEST(NodeElimination, PredictsTheTrueRise) {
  const Fit fit;
  const double E = fit.objective.Value(fit.model);
  TableLayout layout = TableLayout::Full(fit.model.spec());
  for (const Elimination& next : OrderOfElimination(fit.at, fit.model, layout, NoLimits(8))) {
    std::erase(layout.of(next.factor, next.table), next.entry);
    const double rise = Refitted(fit, layout) - E;
    EXPECT_NEAR(next.rise, rise, 0.1 * rise + 1e-6 * E) << layout.num_parameters(fit.model.spec());
  }
}

// The rank-one updates against a minimum computed at once.
TEST(NodeElimination, UpdatesAgreeWithTheReducedProblem) {
  const Fit fit;
  TableLayout layout = TableLayout::Full(fit.model.spec());
  QuadraticModel at = fit.at;
  std::ranges::fill(at.gradient, 0.0);  // the order takes it as 0
  const std::vector<Elimination> order = OrderOfElimination(at, fit.model, layout, NoLimits(12));
  ASSERT_EQ(order.size(), 12);
  for (const Elimination& next : order) {
    std::erase(layout.of(next.factor, next.table), next.entry);
  }
  const Reduction reduction(fit.model.spec(), layout);
  const ReducedPoint lowest = LowestWithin(reduction, at, fit.model.parameters(),
                                           reduction.Restrict(fit.model.parameters()), 1);
  // One counts the damping as a part of E, the other moves less by it; both fix scales, at points
  // that differ a little.
  EXPECT_NEAR(order.back().rise, lowest.rise, 0.05 * lowest.rise);
}

TEST(NodeElimination, KeepsItsLimits) {
  const Fit fit;
  const TableLayout layout = TableLayout::Full(fit.model.spec());
  const std::vector<Elimination> all =
      OrderOfElimination(fit.at, fit.model, layout, NoLimits(1000));
  EXPECT_EQ(all.size(), 8 - 1 + 3 * (8 - 1) + fit.model.spec().g_axis.size - 1);
  for (size_t k = 1; k < all.size(); ++k) EXPECT_GE(all[k].rise, all[k - 1].rise);
  EliminationLimits limits{.max_rise = all[10].rise, .max_count = 1000};
  const size_t within = OrderOfElimination(fit.at, fit.model, layout, limits).size();
  EXPECT_GE(within, 10);  // one or none at the very limit, by rounding
  EXPECT_LE(within, 11);
  limits = NoLimits(1000);
  limits.may_thin[0] = limits.may_thin[2] = false;
  for (const Elimination& next : OrderOfElimination(fit.at, fit.model, layout, limits)) {
    EXPECT_EQ(next.factor, Factor::kF);
  }
}

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

// There are so many constraints that pending changes are applied more than once.
TEST(Tableau, ImposesAndHoldsAsTheEquationsDo) {
  Quadratic q;
  Tableau tableau = MakeTableau(q);
  ASSERT_TRUE(tableau.valid());
  double rise = 0;
  for (int k = 1; k + 1 < kSize; k += 3) {
    const Constraint c = MeanOfNeighbours(k);
    const double by_it = tableau.Rise(c);
    tableau.ImposeConstraint(c);
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
    tableau.ImposeConstraint(c);
    q.constraints.push_back(c);
  }
  const Eigen::VectorXd lowest = q.Lowest();
  tableau.Remove(4);
  ASSERT_EQ(tableau.size(), kSize - 1);
  EXPECT_NEAR(tableau.h(4), lowest[kSize - 1], 1e-9);
  // Constraint on the last parameter, under its new index, and on two others.
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
