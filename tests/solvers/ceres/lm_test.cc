#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/solvers/registry/solvers.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/start/initial_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

SolverOptions Iterations(int count) {
  SolverOptions options;
  options.max_iterations = count;
  options.relative_decrease_tolerance = 0;
  options.diagnose = false;
  return options;
}

struct Iterate {
  IterationRecord record;
  FactorModel model;
};

std::vector<Iterate> Iterates(const std::string& solver, const Objective& objective,
                              SolverOptions options, FactorModel model) {
  std::vector<Iterate> iterates;
  options.on_iteration = [&](const IterationRecord& record, const FactorModel& current) {
    iterates.push_back({record, current});
    return true;
  };
  MakeSolver(solver)->Solve(objective, options, &model);
  return iterates;
}

double LargestDifference(const FactorModel& a, const FactorModel& b) {
  double difference = 0;
  for (size_t k = 0; k < a.parameters().size(); ++k) {
    difference = std::max(difference, std::abs(a.parameters()[k] - b.parameters()[k]));
  }
  return difference / std::ranges::max(b.parameters());
}

// A model and a measurement of it with noise; then the model is moved away.
Objective NoisyObjective(const MerlGrid& grid, int lobes, FactorModel* model) {
  const ModelSpec spec = ModelSpec::SharedFactors(lobes, grid);
  *model = RandomModel(spec, 1, 0.3);
  BrdfTable table = TableOf(*model, grid);
  Random random(2);
  for (std::vector<double>& channel : table.stored) {
    for (double& value : channel) value *= random.LogNormal(0.05);
  }
  for (double& x : model->parameters()) x *= random.LogNormal(0.2);
  return MakeObjective(table, spec);
}

// Rounding errors of J'J and J'r, eps times the root of the number of parameters as they add up at
// random, move a step by at most that over the damping. Ceres damps a first step of Levenberg and
// Marquardt by 1e-4 of the squared columns and a third of it after each success; dogleg's
// Gauss-Newton step by 1e-8.
void ExpectSameIterates(const Objective& objective, const FactorModel& start,
                        const SolverOptions& options, const std::string& what) {
  const double damping = options.trust_region == TrustRegion::kDogleg
                             ? 1e-8
                             : 1e-4 / std::pow(3, options.max_iterations);
  const double tolerance = std::numeric_limits<double>::epsilon() *
                           std::sqrt(objective.spec().num_parameters()) / damping;
  const std::vector<Iterate> condensed = Iterates("lm", objective, options, start);
  const std::vector<Iterate> plain = Iterates("lm_plain", objective, options, start);
  ASSERT_EQ(plain.size(), static_cast<size_t>(options.max_iterations) + 1) << what;
  ASSERT_EQ(condensed.size(), plain.size()) << what;
  EXPECT_LT(plain.back().record.objective, 0.2 * plain.front().record.objective) << what;
  for (size_t k = 0; k < plain.size(); ++k) {
    SCOPED_TRACE(what + ", iteration " + std::to_string(k));
    const double E = plain[k].record.objective;
    EXPECT_NEAR(condensed[k].record.objective, E, tolerance * E);
    EXPECT_EQ(condensed[k].record.accepted, plain[k].record.accepted);
    EXPECT_LE(LargestDifference(condensed[k].model, plain[k].model), tolerance);
    // What the solver remembers of E is E.
    EXPECT_EQ(condensed[k].record.objective, objective.Value(condensed[k].model));
  }
}

// Here lm_plain works by QR: it never forms J'J.
TEST(Lm, GoesWhereLmPlainGoes) {
  constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 10};
  for (const int lobes : {1, 2}) {
    FactorModel start;
    const Objective objective = NoisyObjective(kGrid, lobes, &start);
    for (const TrustRegion trust_region :
         {TrustRegion::kLevenbergMarquardt, TrustRegion::kDogleg}) {
      SolverOptions options = Iterations(6);
      options.positivity = Positivity::kBounds;
      options.trust_region = trust_region;
      ExpectSameIterates(objective, start, options,
                         std::to_string(lobes) + " lobes, " + TrustRegionName(trust_region));
    }
  }
}

// Here the whole Jacobian takes more than 64 MiB, and lm_plain works by sparse normal equations.
TEST(Lm, GoesWhereLmPlainGoesOnALargeProblem) {
  constexpr MerlGrid kGrid{.theta_h = 32, .theta_d = 32, .phi_d = 32};
  FactorModel start;
  const Objective objective = NoisyObjective(kGrid, 2, &start);
  ASSERT_GT(8.0 * kChannels * objective.samples().size() * objective.spec().num_parameters(),
            64 << 20);
  SolverOptions options = Iterations(2);
  options.positivity = Positivity::kBounds;
  ExpectSameIterates(objective, start, options, "bounds");
}

// Parameters that a step has put on their bound, and that E holds there, do not spoil the steps of
// the others: of a material that the model can represent nothing is left. By bounds alone the run
// ends far from any stationary point.
TEST(Lm, GoesOnWhereNumbersAreOnTheirBounds) {
  constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 8};
  FactorModel truth = RandomModel(ModelSpec::SharedFactors(2, kGrid), 3, 0.3);
  for (int k = 0; k < kGrid.theta_h; ++k) {
    truth.table(Factor::kD, 0)[k] *= std::pow(10, -k);
    truth.table(Factor::kD, 1)[k] *= std::pow(10, -0.5 * k);
  }
  const Objective objective = MakeObjective(TableOf(truth, kGrid), truth.spec());
  const auto solve = [&](Positivity positivity) {
    FactorModel model = InitialModels().front().make(objective, 1);
    SolverOptions options = Iterations(500);
    options.optimality_tolerance = 0;
    options.positivity = positivity;
    options.diagnose = true;
    return MakeSolver("lm")->Solve(objective, options, &model);
  };
  const SolverSummary held = solve(Positivity::kActiveSet), bounds = solve(Positivity::kBounds);
  EXPECT_EQ(held.stop_reason, StopReason::kExactFit) << held.BriefReport();
  EXPECT_EQ(held.used.positivity, Positivity::kActiveSet);
  EXPECT_TRUE(held.notes.empty());
  EXPECT_EQ(bounds.stop_reason, StopReason::kNoDecrease) << bounds.BriefReport();
  EXPECT_GT(bounds.diagnosis->optimality, 1e-3);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
