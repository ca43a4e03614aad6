// Data made from a model of the same form are fitted exactly from a perturbed start, and the tables
// come back.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "model/objective/gauge.h"
#include "tests/test_util.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

struct Case {
  std::string name;
  ModelSpec spec;
  int sweeps;
};

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};

// AWLS moves one element at a time and so converges linearly, at a rate that conditioning decides.
// Rough tables tell the lobes apart; with smooth ones, which differ from each other by little, E
// falls below 1e-5 of its start only after thousands of sweeps, and further ever more slowly.
void ExpectRecovery(const Solver& solver, const Case& problem) {
  const FactorModel truth = RandomModel(problem.spec, 5, 0.7);
  const Objective objective = MakeObjective(TableOf(truth, kGrid), problem.spec);
  FactorModel model = truth;
  Random random(5);
  for (double& x : model.parameters()) x *= random.LogNormal(0.1);
  const FactorModel start = model;

  SolverOptions options;
  options.max_iterations = problem.sweeps;
  options.relative_decrease_tolerance = 0;
  const SolverSummary summary = solver.Solve(objective, options, &model);
  EXPECT_GT(summary.initial_objective, 1e-3 * objective.MeasuredEnergy()) << problem.name;
  EXPECT_LE(summary.final_objective, 1e-12 * summary.initial_objective) << problem.name;

  FactorModel expected = truth;
  Canonicalize(objective.coverage(), &expected);
  Canonicalize(objective.coverage(), &model);
  for (size_t k = 0; k < expected.parameters().size(); ++k) {
    const double x = expected.parameters()[k];
    EXPECT_NEAR(model.parameters()[k], x, 1e-4 * x) << problem.name << ", parameter " << k;
  }
}

TEST(Recovery, Awls) {
  ModelSpec f_per_lobe = ModelSpec::SharedFactors(2, kGrid);
  f_per_lobe.F = {.per_lobe = true, .per_channel = false};
  for (const Case& problem : {Case{"no lobe", ModelSpec::SharedFactors(0, kGrid), 10},
                              Case{"1 lobe", ModelSpec::SharedFactors(1, kGrid), 3000},
                              Case{"2 lobes", ModelSpec::SharedFactors(2, kGrid), 3000},
                              Case{"3 lobes", ModelSpec::SharedFactors(3, kGrid), 3000},
                              Case{"independent G", ModelSpec::IndependentG(kGrid), 5000},
                              Case{"F a lobe", f_per_lobe, 5000}}) {
    ExpectRecovery(*MakeSolver("awls"), problem);
  }
}

TEST(Recovery, LmPlain) {
  for (const Case& problem : {Case{"no lobe", ModelSpec::SharedFactors(0, kGrid), 20},
                              Case{"1 lobe", ModelSpec::SharedFactors(1, kGrid), 100},
                              Case{"3 lobes", ModelSpec::SharedFactors(3, kGrid), 100},
                              Case{"independent G", ModelSpec::IndependentG(kGrid), 100}}) {
    ExpectRecovery(*MakeSolver("lm_plain"), problem);
  }
}

TEST(Recovery, AwlsLiteral) {
  ExpectRecovery(*MakeSolver("awls_literal"), {"1 lobe", ModelSpec::SharedFactors(1, kGrid), 1500});
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
