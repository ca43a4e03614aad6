#include "solvers/joint/reduction.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/test_util.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 8};

TableLayout ThinLayout(const ModelSpec& spec) {
  TableLayout layout = TableLayout::Full(spec);
  layout.coloured_d = layout.coloured_s = false;
  layout.of(Factor::kD, 0) = {1, 4};
  layout.of(Factor::kF, 0) = {0, 2, 3};
  return layout;
}

TEST(Reduction, ExpandsAsALayoutDoes) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const TableLayout layout = ThinLayout(spec);
  const Reduction reduction(spec, layout);
  EXPECT_EQ(reduction.size(), layout.num_parameters(spec));
  FactorModel model = RandomModel(spec, 1);
  ExpandStored(layout, &model);
  const std::vector<double> y = reduction.Restrict(model.parameters());
  const std::vector<double> x = reduction.Expand(y);
  for (int k = 0; k < spec.num_parameters(); ++k) {
    EXPECT_DOUBLE_EQ(x[k], model.parameters()[k]) << k;
  }
}

TEST(Reduction, SharedTablesReadAsTheModelDoes) {
  for (const NamedSpec& named : TestSpecs(kGrid)) {
    ModelSpec fewer = named.spec;
    fewer.F.per_channel = fewer.G.per_lobe = false;
    const FactorModel shared = RandomModel(fewer, 1);
    const Reduction reduction = Reduction::BySharing(named.spec, fewer);
    FactorModel model(named.spec);
    std::ranges::copy(reduction.Expand(shared.parameters()), model.parameters().begin());
    for (const Factor factor : kFactors) {
      for (int m = 0; m < fewer.lobes; ++m) {
        for (int c = 0; c < kChannels; ++c) {
          EXPECT_TRUE(std::ranges::equal(model.table(factor, named.spec.table(factor, m, c)),
                                         shared.table(factor, fewer.table(factor, m, c))))
              << named.name;
        }
      }
    }
    EXPECT_TRUE(std::ranges::equal(reduction.Restrict(model.parameters()), shared.parameters()));
  }
}

TEST(Reduction, TheReducedProblemIsTheProblemInTheReducedNumbers) {
  ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  ModelSpec fewer = spec;
  fewer.F.per_channel = false;
  const TableLayout layout = ThinLayout(fewer);
  const Reduction reduction =
      Reduction::BySharing(spec, fewer).ComposedWith(Reduction(fewer, layout));
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  FactorModel model = RandomModel(spec, 2);
  const std::vector<double> y = reduction.Restrict(model.parameters());
  std::ranges::copy(reduction.Expand(y), model.parameters().begin());
  QuadraticModel at;
  NormalEquations(objective).Evaluate(model, Hessian::kNewton, &at);
  const QuadraticModel reduced = reduction(at);
  // E along a direction of y, by differences of fourth order.
  Random random(3);
  std::vector<double> direction(y.size());
  for (double& v : direction) v = random.Normal();
  const auto E = [&](double t) {
    std::vector<double> moved = y;
    for (size_t j = 0; j < y.size(); ++j) moved[j] += t * direction[j];
    FactorModel there(spec);
    std::ranges::copy(reduction.Expand(moved), there.parameters().begin());
    return objective.Value(there);
  };
  const double h = 1e-3;
  double slope = 0, curvature = 0;
  for (size_t i = 0; i < y.size(); ++i) {
    slope += reduced.gradient[i] * direction[i];
    for (size_t j = 0; j < y.size(); ++j) {
      curvature += direction[i] * reduced.H[i * y.size() + j] * direction[j];
    }
  }
  const double first = (8 * (E(h) - E(-h)) - (E(2 * h) - E(-2 * h))) / (12 * h);
  const double second = (16 * (E(h) + E(-h)) - (E(2 * h) + E(-2 * h)) - 30 * E(0)) / (12 * h * h);
  EXPECT_NEAR(first, 2 * slope, 1e-7 * std::abs(slope));
  EXPECT_NEAR(second, 2 * curvature, 1e-6 * curvature);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
