// Measurements in any unit, from 1e-300 to 1e300 per steradian: a right fit, or an Error that names
// the factor that makes it one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/error_of.h"
#include "tests/solvers/solver_kinds.h"
#include "tests/test_util.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 12};
std::vector<int> Exponents() {
  if (kSanitized) return {-300, -167, -100, -48, 0, 48, 154, 300};
  return {-300, -250, -200, -167, -163, -150, -120, -100, -70, -52, -48, -30, -10,
          0,    10,   30,   48,   52,   70,   100,  140,  154, 167, 200, 250, 300};
}

BrdfSamples Scaled(BrdfSamples samples, double factor) {
  for (Rgb& rho : samples.rho) {
    for (double& x : rho) x *= factor;
  }
  return samples;
}

// A model of the form that is fitted, each value multiplied by noise of 5 %; the largest is 1.
const BrdfSamples& Measured() {
  static const BrdfSamples samples = [] {
    const FactorModel model = RandomModel(ModelSpec::SharedFactors(1, kGrid), 1);
    BrdfSamples samples = ValidSamples(TableOf(model, kGrid));
    Random random(1);
    double largest = 0;
    for (Rgb& rho : samples.rho) {
      for (double& x : rho) {
        x *= random.LogNormal(0.05);
        largest = std::max(largest, x);
      }
    }
    return Scaled(std::move(samples), 1 / largest);
  }();
  return samples;
}

// A fit, and that it is right: of noise of 5 %, E is a quarter of a percent of a black model's.
void ExpectRightFit(const SolverEntry& solver, const Objective& objective) {
  FactorModel model = InitialModels().front().make(objective, 1);
  SolverOptions options;
  options.max_iterations = 60;
  options.starts = 2;
  options.relative_decrease_tolerance = 1e-4;
  const SolverSummary summary = solver.make()->Solve(objective, options, &model);
  EXPECT_NE(summary.stop_reason, StopReason::kExactFit);
  EXPECT_TRUE(std::isfinite(summary.final_objective));
  EXPECT_GT(summary.final_objective, 0);
  ASSERT_TRUE(summary.diagnosis);
  EXPECT_TRUE(std::isfinite(summary.diagnosis->optimality));
  EXPECT_NO_THROW(CheckParameters(model));
  const ScoreReport score = ScoreModel(objective, model);
  // awls_gss has a G that is linear between nodes, which on so coarse a grid are far apart: it ends
  // higher.
  EXPECT_LT(score.relative_objective, solver.name == "awls_gss" ? 0.1 : 0.01);
  EXPECT_GT(score.psnr_db, 15);
  EXPECT_LT(score.psnr_db, 80);
}

class Range : public testing::TestWithParam<std::string> {};

TEST_P(Range, ARightFitOrAnErrorThatNamesTheFactor) {
  const SolverEntry& solver = FindSolver(GetParam());
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  int fitted = 0, refused = 0;
  const std::vector<int> exponents = Exponents();
  for (const Weighting& weighting : Weightings()) {
    for (const int& exponent : exponents) {
      const auto choices = {NumberOf(weighting, Weightings()), NumberOf(exponent, exponents)};
      if (kSanitized && !IsOneIn(3, choices)) continue;
      SCOPED_TRACE(weighting.name + ", 1e" + std::to_string(exponent));
      const BrdfSamples samples = Scaled(Measured(), std::pow(10.0, exponent));
      if (std::abs(exponent) < 50) {
        ExpectRightFit(solver, Objective(samples, spec, weighting));
        ++fitted;
        continue;
      }
      const auto thrown = ErrorOf([&] { Objective(samples, spec, weighting); });
      ASSERT_TRUE(thrown);
      const std::string error = thrown->what();  // which power helps, it says in words alone
      const size_t at = error.rfind("by 2^");
      ASSERT_NE(at, std::string::npos) << error;
      const int power = std::stoi(error.substr(at + 5));
      ++refused;
      if (exponent % 100 != 0 || UpdatesElements(solver)) continue;
      // In two steps, since 2^power may be out of range itself.
      const BrdfSamples mended =
          Scaled(Scaled(samples, std::exp2(power / 2)), std::exp2(power - power / 2));
      ExpectRightFit(solver, Objective(mended, spec, weighting));
    }
  }
  EXPECT_GT(fitted, 0);
  EXPECT_GT(refused, 0);
}

// Equal to the last bit, since a power of two changes exponents only (docs/objective.md).
TEST_P(Range, DataTimesAPowerOfTwoHaveTheSameTables) {
  const SolverEntry& solver = FindSolver(GetParam());
  const auto fitted = [&](int k) {
    const Objective objective(Scaled(Measured(), std::exp2(k)), ModelSpec::SharedFactors(2, kGrid),
                              FindWeighting("appearance"));
    FactorModel model = InitialModels().front().make(objective, 1);
    solver.make()->Solve(objective, {.max_iterations = 10, .diagnose = false, .starts = 2}, &model);
    return model;
  };
  const FactorModel expected = fitted(0);
  for (const int k : {-30, -3, 1, 20}) {
    SCOPED_TRACE(k);
    FactorModel model = fitted(k);
    for (double& d : model.d()) d = std::ldexp(d, -k);
    for (int m = 0; m < model.spec().lobes; ++m) {
      for (double& s : model.s(m)) s = std::ldexp(s, -k);
    }
    EXPECT_THAT(model.parameters(), testing::ElementsAreArray(expected.parameters()));
  }
}

std::vector<std::string> SolverNames() {
  std::vector<std::string> names;
  for (const SolverEntry& solver : kLibrarySolvers) {
    if (KnowsUnits(solver)) names.push_back(solver.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Solvers, Range, testing::ValuesIn(SolverNames()),
                         [](const auto& param) { return param.param; });

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
