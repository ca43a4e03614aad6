#include "solvers/joint/joint_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};

// Data of the model's own form, and a start near the truth.
struct ExactCase {
  std::string name;
  FactorModel truth, start;
  Objective objective;

  // How many decades E is below that of the black model.
  double Decades(double E) const { return -std::log10(E / objective.MeasuredEnergy()); }
};

// Rough tables tell the lobes apart: the condition of J is below 50 but for the gauge.
template <typename Visit>
void ForEachExactCase(const Visit& visit) {
  for (const auto& [name, spec] : {NamedSpec{"1 lobe", ModelSpec::SharedFactors(1, kGrid)},
                                   NamedSpec{"2 lobes", ModelSpec::SharedFactors(2, kGrid)},
                                   NamedSpec{"3 lobes", ModelSpec::SharedFactors(3, kGrid)},
                                   NamedSpec{"independent G", ModelSpec::IndependentG(kGrid)}}) {
    const FactorModel truth = RandomModel(spec, 5, 0.7);
    FactorModel start = truth;
    Random random(5);
    for (double& x : start.parameters()) x *= random.LogNormal(0.01);
    visit(ExactCase{name, truth, start, MakeObjective(TableOf(truth, kGrid), spec)});
  }
}

// Decades of decrease at which a fit is exact to rounding.
constexpr double kFloorDecades = 27;

// Undamped Gauss-Newton steps square the error: E' <= C^2 E^2, with E in units of the black model's
// and C a number of the problem. That C^2 is below 10 here, so that 5 decades and more become at
// least 9/5 of them, 2 * 5 - 1.
void ExpectQuadratic(double decades, double next_decades, const std::string& what) {
  EXPECT_GE(next_decades, std::min(1.8 * decades, kFloorDecades)) << what << ", at " << decades;
}

TEST(JointStepper, SquaresTheErrorOnceDampingHasGone) {
  ForEachExactCase([](const ExactCase& exact) {
    for (const auto trial : {JointStepper::Trial::kAsItIs, JointStepper::Trial::kProjected}) {
      for (const auto curvature :
           {JointStepper::Curvature::kGaussNewton, JointStepper::Curvature::kByProgress}) {
        PhaseSeconds phases;
        JointStepper stepper(exact.objective, curvature, trial, &phases);
        for (int k = 0; k < 25; ++k) {  // good steps, that bring lambda down to its least
          stepper.Restart(exact.start);
          EXPECT_TRUE(stepper.Step()) << exact.name;
        }
        stepper.Restart(exact.start);
        int squared = 0;
        for (double before = 0; before < kFloorDecades;) {
          const double now = exact.Decades(stepper.E());
          if (before >= 5) {
            ExpectQuadratic(before, now, exact.name);
            ++squared;
          }
          before = now;
          if (!stepper.Step()) break;
          EXPECT_EQ(stepper.E(), exact.objective.Value(stepper.current())) << exact.name;
        }
        EXPECT_GE(squared, 2) << exact.name;
        EXPECT_GE(exact.Decades(stepper.E()), kFloorDecades) << exact.name;
      }
    }
  });
}

// A solver's own damping is there at the start and falls to a third with each good step. In the end
// it is what is left of the error: a step leaves lambda / (sigma^2 + lambda) of it in the direction
// of a singular value sigma, so with lambda far below all sigma^2 each step lowers E by a factor
// that is 9 times that of the step before. Directions with larger sigma, which vanish first, make
// that less for a while: 4 times is asked for.
TEST(JointSolvers, ReachAnExactFitFasterAndFaster) {
  ForEachExactCase([](const ExactCase& exact) {
    for (const char* const solver : {"newton", "varpro", "lm"}) {
      const std::string what = exact.name + ", " + solver;
      FactorModel model = exact.start;
      SolverOptions options;
      options.max_iterations = 20;
      options.relative_decrease_tolerance = 0;
      options.optimality_tolerance = 0;
      options.diagnose = false;
      const SolverSummary summary = MakeSolver(solver)->Solve(exact.objective, options, &model);
      EXPECT_LE(summary.final_objective, 1e-20 * summary.initial_objective) << what;
      std::vector<double> decades;
      for (const IterationRecord& record : summary.trace) {
        if (record.accepted) decades.push_back(exact.Decades(record.objective));
      }
      int compared = 0;
      for (size_t k = 1; k + 1 < decades.size(); ++k) {
        if (std::string(solver) == "lm") {
          // The trust region of Ceres starts wide and lets the first steps square the error.
          if (decades[k] < 5 || decades[k] > 9) continue;
          ExpectQuadratic(decades[k], decades[k + 1], what);
        } else {
          if (decades[k] < decades[0] + 10 || decades[k + 1] > kFloorDecades) continue;
          EXPECT_GE(decades[k + 1] - decades[k], decades[k] - decades[k - 1] + std::log10(4.0))
              << what << ", step " << k + 1;
        }
        ++compared;
      }
      EXPECT_GE(compared, 1) << what;
    }
  });
}

// Next to a lobe of almost no weight E curves down steeply, and only heavy damping makes steps that
// lower it: first by next to nothing, which is no convergence.
TEST(JointSolvers, GoOnWhereDampingIsWhatHoldsThemBack) {
  const FactorModel truth = RandomModel(ModelSpec::SharedFactors(2, kGrid), 2, 0.7);
  BrdfTable table = TableOf(truth, kGrid);
  Random random(3);
  for (auto& plane : table.stored) {
    for (double& x : plane) x *= random.LogNormal(0.1);
  }
  const Objective objective = MakeObjective(table, truth.spec());
  SolverOptions options;
  options.max_iterations = 100;
  options.relative_decrease_tolerance = 1e-6;
  FactorModel minimum = truth;
  const double least = MakeSolver("newton")->Solve(objective, options, &minimum).final_objective;
  for (const double share : {1e-6, 1e-9, 1e-12, 1e-15}) {
    for (const char* const solver : {"newton", "varpro", "hybrid"}) {
      FactorModel model = truth;
      for (double& s : model.s(1)) s *= share;
      const double E = MakeSolver(solver)->Solve(objective, options, &model).final_objective;
      EXPECT_LE(E, least * (1 + 1e-4)) << solver << ", " << share;
    }
  }
}

// In the end a step's decrease is below the rounding of E, so that the last bits of E decide
// whether it is accepted. Other noise makes other bits, as another processor does.
TEST(JointSolvers, EndWhereTheRoundingOfEDecides) {
  for (int seed = 1; seed <= 8; ++seed) {
    const FactorModel truth = RandomModel(ModelSpec::SharedFactors(2, kGrid), 5, 0.7);
    BrdfTable table = TableOf(truth, kGrid);
    Random random(seed);
    for (auto& plane : table.stored) {
      for (double& x : plane) x *= random.LogNormal(0.05);
    }
    const Objective objective = MakeObjective(table, truth.spec());
    SolverOptions options;
    options.max_iterations = 100;
    options.relative_decrease_tolerance = options.optimality_tolerance = 0;
    for (const char* const solver : {"newton", "varpro", "hybrid"}) {
      FactorModel model = truth;
      const SolverSummary summary = MakeSolver(solver)->Solve(objective, options, &model);
      EXPECT_EQ(summary.stop_reason, StopReason::kOptimal) << solver << ", seed " << seed;
      EXPECT_LE(summary.RejectedSteps(), 3) << solver << ", seed " << seed;
      EXPECT_LE(summary.diagnosis->optimality, 1e-6) << solver << ", seed " << seed;
    }
  }
}

// A start from which nothing can be gained.
class WarmStart : public testing::TestWithParam<std::string> {};

TEST_P(WarmStart, StaysAtAnExactFit) {
  const FactorModel truth = RandomModel(ModelSpec::SharedFactors(2, kGrid), 5);
  const Objective objective = MakeObjective(TableOf(truth, kGrid), truth.spec());
  FactorModel model = truth;
  const SolverSummary summary = MakeSolver(GetParam())->Solve(objective, {}, &model);
  EXPECT_EQ(summary.stop_reason, StopReason::kExactFit);
  EXPECT_EQ(summary.iterations, 0);
  EXPECT_TRUE(std::ranges::equal(model.parameters(), truth.parameters()));
}

TEST_P(WarmStart, StaysAtAMinimum) {
  // Noise leaves a residual, and some parameters at 0.
  FactorModel truth = RandomModel(ModelSpec::SharedFactors(2, kGrid), 5, 0.7);
  for (int h = 0; h < kGrid.theta_h; h += 3) truth.table(Factor::kD, 0)[h] = 0;
  BrdfTable table = TableOf(truth, kGrid);
  Random random(7);
  for (auto& plane : table.stored) {
    for (double& x : plane) x *= random.LogNormal(0.05);
  }
  const Objective objective = MakeObjective(table, truth.spec());
  FactorModel minimum = truth;
  SolverOptions options;
  options.max_iterations = 100;
  options.relative_decrease_tolerance = 0;
  options.optimality_tolerance = 1e-12;
  ASSERT_EQ(MakeSolver("newton")->Solve(objective, options, &minimum).stop_reason,
            StopReason::kOptimal);

  FactorModel model = minimum;
  const SolverSummary summary = MakeSolver(GetParam())->Solve(objective, {}, &model);
  // One that does not know the gradient takes an iteration to see that it moves nothing; Ceres, all
  // of whose tolerances are off, and a search for lower E take steps back until these have
  // vanished.
  EXPECT_LE(summary.iterations - summary.RejectedSteps(), 1);
  EXPECT_LE(summary.iterations, 30);
  EXPECT_LE(summary.final_objective, summary.initial_objective);
  EXPECT_GE(summary.final_objective, summary.initial_objective * (1 - 1e-12));
  for (size_t k = 0; k < model.parameters().size(); ++k) {
    const double x = minimum.parameters()[k];
    EXPECT_NEAR(model.parameters()[k], x, 1e-6 * (1 + x)) << "parameter " << k;
  }
}

std::vector<std::string> SolverNames() {
  std::vector<std::string> names;
  for (const SolverEntry& solver : Solvers()) names.push_back(solver.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Solvers, WarmStart, testing::ValuesIn(SolverNames()),
                         [](const auto& param) { return param.param; });

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
