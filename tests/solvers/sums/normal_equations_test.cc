#include "trilobe/solvers/sums/normal_equations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 7, .phi_d = 12};

// Relative to the lengths of the two columns (and of the residual): what a Gauss-Newton step sees.
void ExpectEqual(const QuadraticModel& actual, const QuadraticModel& expected,
                 const std::string& what) {
  const size_t n = expected.gradient.size();
  ASSERT_EQ(actual.gradient.size(), n);
  EXPECT_NEAR(actual.objective, expected.objective, 1e-12 * expected.objective) << what;
  const auto length = [&](size_t k) { return std::sqrt(expected.squared_lengths[k]); };
  int wrong = 0;
  for (size_t k = 0; k < n; ++k) {
    const double scale = 1e-11 * length(k);
    wrong += !(std::abs(actual.gradient[k] - expected.gradient[k]) <=
               scale * std::sqrt(expected.objective));
    for (size_t l = 0; l < n; ++l) {
      const double H = expected.H[k * n + l];
      wrong += !(std::abs(actual.H[k * n + l] - H) <= scale * length(l) + 1e-11 * std::abs(H));
    }
  }
  EXPECT_EQ(wrong, 0) << what;
}

// E and both kinds of equations at a random model.
void ExpectEqualReference(const Objective& objective, const std::string& what) {
  const FactorModel model = RandomModel(objective.spec(), 4);
  EXPECT_NEAR(objective.Value(model), static_cast<double>(ExactObjective(objective, model)),
              1e-12 * objective.Value(model));
  QuadraticModel actual, expected;
  for (const Hessian hessian : {Hessian::kGaussNewton, Hessian::kNewton}) {
    NormalEquations(objective).Evaluate(model, hessian, &actual);
    EvaluateReference(objective, model, hessian, &expected);
    ExpectEqual(actual, expected, what);
  }
}

// Sets a third of all parameters to 0, the bound.
void PutSomeAtZero(FactorModel* model) {
  Random random(5);
  for (double& x : model->parameters()) {
    if (random.Uniform() < 0.3) x = 0;
  }
}

TEST(NormalEquations, CondensedEqualsReference) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    for (const char* const weighting : {"compressive", "uniform"}) {
      const Objective objective = MakeObjective(RandomTable(kGrid, 3), spec, weighting);
      NormalEquations equations(objective);
      for (const bool zeros : {false, true}) {
        FactorModel model = RandomModel(spec, 4);
        if (zeros) PutSomeAtZero(&model);
        QuadraticModel actual, expected;
        for (const Hessian hessian : {Hessian::kGaussNewton, Hessian::kNewton}) {
          equations.Evaluate(model, hessian, &actual);
          EvaluateReference(objective, model, hessian, &expected);
          ExpectEqual(actual, expected,
                      name + ", " + weighting + (zeros ? ", with zeros" : "") +
                          (hessian == Hessian::kNewton ? ", Newton" : ""));
        }
      }
    }
  }
}

TEST(NormalEquations, OfScatteredSamplesEqualReference) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    BrdfSamples samples = Scattered(ValidSamples(RandomTable(kGrid, 3)));
    for (HalfDiffAngles& at : samples.angles) at.theta_h *= 0.9;
    std::vector<QuadraticModel> by_threads;
    for (const int threads : {1, 3}) {
      const Objective objective(samples, spec, FindWeighting("uniform"), threads);
      NormalEquations equations(objective);
      for (const bool zeros : {false, true}) {
        FactorModel model = RandomModel(spec, 4);
        if (zeros) PutSomeAtZero(&model);
        QuadraticModel expected;
        for (const Hessian hessian : {Hessian::kGaussNewton, Hessian::kNewton}) {
          by_threads.emplace_back();
          equations.Evaluate(model, hessian, &by_threads.back());
          equations.Evaluate(model, hessian, &by_threads.back());  // anew, in the same place
          EvaluateReference(objective, model, hessian, &expected);
          ExpectEqual(by_threads.back(), expected, name + (zeros ? ", with zeros" : ""));
        }
      }
    }
    for (int k = 0; k < 4; ++k) EXPECT_EQ(by_threads[k].H, by_threads[4 + k].H) << name;
  }
}

// The greatest number of readings of D, in two vectors of lobes; and a D for each channel.
TEST(NormalEquations, OfLobesThatAreAllStretchedDifferently) {
  for (const bool per_channel : {false, true}) {
    ModelSpec spec = ModelSpec::SharedFactors(per_channel ? 3 : kMaxLobes, kGrid);
    spec.D.per_channel = per_channel;
    std::vector<Stretch> stretches;
    for (int m = 0; m < spec.lobes; ++m) {
      stretches.push_back({.along = 0.2 * m - 0.5, .across = 0.4 - 0.1 * m});
    }
    spec.stretches = Stretches(stretches);
    ExpectEqualReference(MakeObjective(RandomTable(kGrid, 3), spec, "compressive"),
                         per_channel ? "D by channel" : "eight lobes");
  }
}

// Lobes need two vectors, each factor's tables one.
TEST(NormalEquations, OfManyLobesThatShareAllTables) {
  ModelSpec spec = ModelSpec::SharedFactors(5, kGrid);
  spec.D = spec.F = spec.G = {.per_lobe = false, .per_channel = false};
  ExpectEqualReference(
      {Scattered(ValidSamples(RandomTable(kGrid, 3))), spec, FindWeighting("compressive")},
      "five lobes");
}

TEST(NormalEquations, AreTheDerivativesOfTheObjective) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 3), spec, "compressive");
  const FactorModel model = RandomModel(spec, 6);
  QuadraticModel at;
  EvaluateReference(objective, model, Hessian::kNewton, &at);
  for (int k = 0; k < spec.num_parameters(); ++k) {
    constexpr double kStep = 1e-5;
    FactorModel below = model, above = model;
    below.parameters()[k] -= kStep;
    above.parameters()[k] += kStep;
    const double slope = (objective.Value(above) - objective.Value(below)) / (2 * kStep);
    EXPECT_NEAR(2 * at.gradient[k], slope, 1e-6 * at.objective) << k;
    QuadraticModel at_below, at_above;
    EvaluateReference(objective, below, Hessian::kNewton, &at_below);
    EvaluateReference(objective, above, Hessian::kNewton, &at_above);
    for (int l = 0; l < spec.num_parameters(); ++l) {
      const double curvature = (at_above.gradient[l] - at_below.gradient[l]) / (2 * kStep);
      EXPECT_NEAR(at.H[static_cast<size_t>(k) * spec.num_parameters() + l], curvature,
                  1e-6 * at.objective)
          << k << ", " << l;
    }
  }
}

TEST(NormalEquations, SameBitsForAnyNumberOfThreads) {
  const ModelSpec spec = ModelSpec::SharedFactors(3, kGrid);
  const FactorModel model = RandomModel(spec, 4);
  QuadraticModel one;
  for (const int threads : {1, 2, 3, 7}) {
    const Objective objective(ValidSamples(RandomTable(kGrid, 3)), spec,
                              FindWeighting("compressive"), threads);
    QuadraticModel many;
    NormalEquations(objective).Evaluate(model, Hessian::kNewton, &many);
    if (threads == 1) one = many;
    EXPECT_EQ(many.objective, one.objective);
    EXPECT_EQ(many.gradient, one.gradient);
    EXPECT_EQ(many.H, one.H);
  }
}

TEST(NormalEquations, UnobservedBinsAreZero) {
  BrdfTable table = RandomTable(kGrid, 3);
  InvalidateThetaH(2, 0, &table);
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(table, spec);
  QuadraticModel result;
  NormalEquations(objective).Evaluate(RandomModel(spec, 4), Hessian::kNewton, &result);
  const size_t n = result.gradient.size();
  int unobserved = 0;
  for (size_t k = 0; k < n; ++k) {
    if (objective.coverage()[k] > 0) continue;
    ++unobserved;
    EXPECT_EQ(result.gradient[k], 0);
    for (size_t l = 0; l < n; ++l) EXPECT_EQ(result.H[k * n + l], 0);
  }
  EXPECT_GE(unobserved, 2);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
