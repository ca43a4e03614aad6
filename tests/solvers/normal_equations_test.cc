#include "trilobe/solvers/normal_equations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/test_util.h"

namespace trilobe {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 7, .phi_d = 12};

// Relative to the lengths of the two columns (and of the residual): what a Gauss-Newton step sees.
void ExpectEqual(const GaussNewtonModel& actual, const GaussNewtonModel& expected,
                 const std::string& what) {
  const size_t n = expected.gradient.size();
  ASSERT_EQ(actual.gradient.size(), n);
  EXPECT_NEAR(actual.objective, expected.objective, 1e-12 * expected.objective) << what;
  const auto length = [&](size_t k) { return std::sqrt(expected.JtJ[k * n + k]); };
  int wrong = 0;
  for (size_t k = 0; k < n; ++k) {
    const double scale = 1e-11 * length(k);
    wrong += !(std::abs(actual.gradient[k] - expected.gradient[k]) <=
               scale * std::sqrt(expected.objective));
    for (size_t l = 0; l < n; ++l) {
      wrong += !(std::abs(actual.JtJ[k * n + l] - expected.JtJ[k * n + l]) <= scale * length(l));
    }
  }
  EXPECT_EQ(wrong, 0) << what;
}

// Sets a third of all numbers to 0, the bound.
void PutSomeAtZero(FactorModel* model) {
  Random random(5);
  for (double& x : model->parameters()) {
    if (random.Uniform() < 0.3) x = 0;
  }
}

TEST(NormalEquations, CondensedEqualsLiteral) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    for (const char* const weighting : {"compressive", "uniform"}) {
      const Objective objective = MakeObjective(RandomTable(kGrid, 3), spec, weighting);
      NormalEquations equations(objective);
      for (const bool zeros : {false, true}) {
        FactorModel model = RandomModel(spec, 4);
        if (zeros) PutSomeAtZero(&model);
        GaussNewtonModel actual, expected;
        equations.Evaluate(model, &actual);
        EvaluateLiterally(objective, model, &expected);
        ExpectEqual(actual, expected, name + ", " + weighting + (zeros ? ", with zeros" : ""));
      }
    }
  }
}

TEST(NormalEquations, AreTheDerivativesOfTheObjective) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 3), spec, "compressive");
  const FactorModel model = RandomModel(spec, 6);
  GaussNewtonModel at;
  EvaluateLiterally(objective, model, &at);
  for (int k = 0; k < spec.num_parameters(); ++k) {
    constexpr double kStep = 1e-5;
    FactorModel below = model, above = model;
    below.parameters()[k] -= kStep;
    above.parameters()[k] += kStep;
    const double slope = (objective.Value(above) - objective.Value(below)) / (2 * kStep);
    EXPECT_NEAR(2 * at.gradient[k], slope, 1e-6 * at.objective) << k;
  }
}

TEST(NormalEquations, SameBitsForAnyNumberOfThreads) {
  const ModelSpec spec = ModelSpec::SharedFactors(3, kGrid);
  const FactorModel model = RandomModel(spec, 4);
  GaussNewtonModel one;
  for (const int threads : {1, 2, 3, 7}) {
    const Objective objective(ValidSamples(RandomTable(kGrid, 3)), spec,
                              FindWeighting("compressive"), threads);
    GaussNewtonModel many;
    NormalEquations(objective).Evaluate(model, &many);
    if (threads == 1) one = many;
    EXPECT_EQ(many.objective, one.objective);
    EXPECT_EQ(many.gradient, one.gradient);
    EXPECT_EQ(many.JtJ, one.JtJ);
  }
}

TEST(NormalEquations, DeadBinsAreZero) {
  BrdfTable table = RandomTable(kGrid, 3);
  for (int d = 0; d < kGrid.theta_d; ++d) {
    for (int p = 0; p < kGrid.phi_d; ++p) table.stored[0][kGrid.Index(2, d, p)] = -1;
  }
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(table, spec);
  GaussNewtonModel result;
  NormalEquations(objective).Evaluate(RandomModel(spec, 4), &result);
  const size_t n = result.gradient.size();
  int dead = 0;
  for (size_t k = 0; k < n; ++k) {
    if (objective.coverage()[k] > 0) continue;
    ++dead;
    EXPECT_EQ(result.gradient[k], 0);
    for (size_t l = 0; l < n; ++l) EXPECT_EQ(result.JtJ[k * n + l], 0);
  }
  EXPECT_GE(dead, 2);
}

}  // namespace
}  // namespace trilobe
