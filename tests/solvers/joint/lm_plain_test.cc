#include <ceres/ordered_groups.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string>
#include <vector>

#include "solvers/joint/ceres_run.h"
#include "solvers/joint/plain_problem.h"
#include "tests/error_of.h"
#include "tests/solvers/joint/noisy_objective.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 10};
constexpr LinearSolver kLinearSolvers[] = {LinearSolver::kDenseQr,
                                           LinearSolver::kDenseNormalCholesky,
                                           LinearSolver::kSparseNormalCholesky,
                                           LinearSolver::kDenseSchur,
                                           LinearSolver::kSparseSchur,
                                           LinearSolver::kIterativeSchur,
                                           LinearSolver::kCgnr};

bool IsIterative(LinearSolver linear_solver) {
  return linear_solver == LinearSolver::kIterativeSchur || linear_solver == LinearSolver::kCgnr;
}

SolverOptions Iterations(int count) {
  SolverOptions options;
  options.max_iterations = count;
  options.relative_decrease_tolerance = 0;
  return options;
}

// A measurement of samples that lie between bins.
Objective BetweenBins(const ModelSpec& spec) {
  BrdfSamples samples = Scattered(ValidSamples(RandomTable(kGrid, 1)));
  for (HalfDiffAngles& angles : samples.angles) angles.theta_h *= 0.9;
  return {samples, spec, FindWeighting("uniform")};
}

TEST(LmPlain, LowersE) {
  const BrdfTable table = RandomTable(kGrid, 1);
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    if (kSanitized && spec.lobes > 2) continue;
    const Objective objective = MakeObjective(table, spec);
    for (const TrustRegion trust_region :
         {TrustRegion::kLevenbergMarquardt, TrustRegion::kDogleg}) {
      FactorModel model = RandomModel(spec, 2);
      SolverOptions options = Iterations(20);
      options.trust_region = trust_region;
      const SolverSummary run = MakeSolver("lm_plain")->Solve(objective, options, &model);
      const std::string what = name + ", " + TrustRegionName(trust_region);
      EXPECT_LT(run.final_objective, 0.7 * run.initial_objective) << what;
      EXPECT_EQ(objective.Value(model), run.final_objective) << what;
      EXPECT_GE(std::ranges::min(model.parameters()), 0) << what;
      EXPECT_GT(run.phases.preparing, 0);
      EXPECT_GT(run.phases.evaluating, 0);
      EXPECT_GT(run.phases.linear_algebra, 0);
    }
  }
}

// Its residual blocks, and their derivatives, add up to E and its gradient.
TEST(LmPlain, IsTheProblemOfAllSamples) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
    const FactorModel model = RandomModel(spec, 2);
    const CeresParameters parameters(objective, model);
    PlainProblem problem(parameters);
    std::vector<double*> blocks;
    problem.problem()->GetParameterBlocks(&blocks);
    for (double* const block : blocks) {  // all of the gradient, unobserved parameters included
      problem.problem()->SetParameterBlockVariable(block);
      problem.problem()->SetManifold(block, nullptr);
    }
    double cost = 0;
    std::vector<double> gradient;
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = blocks;
    ASSERT_TRUE(problem.problem()->Evaluate(options, &cost, nullptr, &gradient, nullptr));
    QuadraticModel all;
    EvaluateReference(objective, model, Hessian::kGaussNewton, &all);
    const double unit = parameters.residual_unit(), E = all.objective;
    EXPECT_NEAR(2 * unit * unit * cost, E, 1e-12 * E) << name;
    // d and s are in units of their own, so each entry is compared by E's decrease along x.
    double sum = 0, expected = 0;
    size_t k = 0;
    for (const double* const block : blocks) {
      const int size = problem.problem()->ParameterBlockSize(block);
      for (int i = 0; i < size; ++i) sum += unit * unit * gradient[k + i] * block[i];
      k += size;
    }
    for (size_t i = 0; i < all.gradient.size(); ++i) {
      expected += all.gradient[i] * model.parameters()[i];
    }
    EXPECT_NEAR(sum, expected, 1e-10 * E) << name;
  }
}

// All exact linear solvers give the same steps. Iterative ones end their steps early, and come as
// low.
TEST(LmPlain, ComesToTheSameEByAnyLinearSolver) {
  FactorModel start;
  const Objective objective = NoisyObjective(kGrid, 2, &start);
  double by_qr = 0;
  for (const LinearSolver linear_solver : kLinearSolvers) {
    FactorModel model = start;
    SolverOptions options = Iterations(10);
    options.linear_solver = linear_solver;
    const SolverSummary run = MakeSolver("lm_plain")->Solve(objective, options, &model);
    const double E = run.final_objective;
    if (linear_solver == LinearSolver::kDenseQr) by_qr = E;
    if (IsIterative(linear_solver)) {
      EXPECT_LT(E, 1.01 * by_qr) << LinearSolverName(linear_solver);
    } else {
      EXPECT_NEAR(E, by_qr, 1e-6 * by_qr) << LinearSolverName(linear_solver);
    }
    EXPECT_EQ(run.used.linear_solver, linear_solver);
    EXPECT_TRUE(run.notes.empty()) << run.notes.front();
  }
}

// For samples between rows of D, only some of these can be eliminated.
TEST(LmPlain, EliminatesBetweenBins) {
  const Objective objective = BetweenBins(ModelSpec::SharedFactors(2, kGrid));
  const FactorModel start = RandomModel(objective.spec(), 2);
  double E[2];
  for (const bool schur : {false, true}) {
    FactorModel model = start;
    SolverOptions options = Iterations(3);
    options.linear_solver = schur ? LinearSolver::kSparseSchur : LinearSolver::kDenseQr;
    E[schur ? 1 : 0] = MakeSolver("lm_plain")->Solve(objective, options, &model).final_objective;
  }
  EXPECT_LT(E[0], 0.9 * objective.Value(start));
  EXPECT_NEAR(E[1], E[0], 1e-6 * E[0]);
}

TEST(LmPlain, SaysWhichLinearSolverItChose) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(1, kGrid));
  FactorModel model = RandomModel(objective.spec(), 1);
  const SolverSummary run = MakeSolver("lm_plain")->Solve(objective, Iterations(1), &model);
  EXPECT_EQ(run.used.linear_solver, LinearSolver::kDenseQr);
  EXPECT_THAT(run.FullReport(), testing::HasSubstr("linear_solver dense_qr (given auto)"));
}

TEST(LmPlain, TellsCeresWhatTheOptionsSay) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(1, kGrid));
  const CeresParameters parameters(objective, RandomModel(objective.spec(), 1));
  PlainProblem problem(parameters);
  SolverOptions options;
  options.linear_solver = LinearSolver::kDenseQr;
  const ceres::Solver::Options plain = problem.OptionsFor(options, 1);
  EXPECT_EQ(plain.linear_solver_type, ceres::DENSE_QR);
  EXPECT_EQ(plain.trust_region_strategy_type, ceres::LEVENBERG_MARQUARDT);
  EXPECT_FALSE(plain.use_nonmonotonic_steps);
  EXPECT_FALSE(plain.use_inner_iterations);
  EXPECT_EQ(plain.linear_solver_ordering, nullptr);

  options.trust_region = TrustRegion::kDogleg;
  options.nonmonotonic = true;
  options.inner_iterations = true;
  const ceres::Solver::Options other = problem.OptionsFor(options, 1);
  EXPECT_EQ(other.trust_region_strategy_type, ceres::DOGLEG);
  EXPECT_TRUE(other.use_nonmonotonic_steps);
  EXPECT_TRUE(other.use_inner_iterations);

  options.trust_region = TrustRegion::kLevenbergMarquardt;
  for (const LinearSolver linear_solver : kLinearSolvers) {
    options.linear_solver = linear_solver;
    std::string name =
        ceres::LinearSolverTypeToString(problem.OptionsFor(options, 1).linear_solver_type);
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    EXPECT_EQ(name, LinearSolverName(linear_solver));
  }
}

// The first elimination group holds rows of D alone: all of a grid, and where samples lie between
// rows as many as no sample reads two of.
TEST(LmPlain, EliminatesIndependentRowsOfD) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective on_grid = MakeObjective(RandomTable(kGrid, 1), spec), between = BetweenBins(spec);
  for (const Objective* const objective : {&on_grid, &between}) {
    const CeresParameters parameters(*objective, RandomModel(spec, 1));
    PlainProblem problem(parameters);
    const ParameterBlocks layout(spec);
    const std::vector<int> rows = problem.IndependentRows();
    EXPECT_EQ(rows.size(), objective == &on_grid ? kGrid.theta_h : kGrid.theta_h / 2);
    for (const WeightedSample& sample : objective->weighted_samples()) {
      const Stencil& D = sample.stencils.D;
      int read = 0;
      for (int k = 0; k < D.size; ++k) {
        read += static_cast<int>(std::ranges::count(rows, layout.row(Factor::kD, D.index[k])));
      }
      EXPECT_LE(read, 1);
    }
    SolverOptions options;
    options.linear_solver = LinearSolver::kDenseSchur;
    const ceres::Solver::Options told = problem.OptionsFor(options, 1);
    ASSERT_NE(told.linear_solver_ordering, nullptr);
    EXPECT_EQ(told.linear_solver_ordering->GroupSize(0), static_cast<int>(rows.size()));
    EXPECT_EQ(told.linear_solver_ordering->NumElements(), problem.problem()->NumParameterBlocks());
  }
}

// Without a lobe there is no D to eliminate.
TEST(LmPlain, SolvesForDAloneByAnyLinearSolver) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(0, kGrid));
  for (const LinearSolver linear_solver : kLinearSolvers) {
    FactorModel model(objective.spec());
    SolverOptions options = Iterations(10);
    options.linear_solver = linear_solver;
    const SolverSummary run = MakeSolver("lm_plain")->Solve(objective, options, &model);
    EXPECT_LT(run.final_objective, run.initial_objective) << LinearSolverName(linear_solver);
    EXPECT_GT(std::ranges::min(model.d()), 0) << LinearSolverName(linear_solver);
  }
}

TEST(LmPlain, SaysWhatCeresDoesNotTake) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(1, kGrid));
  const FactorModel start = RandomModel(objective.spec(), 1);
  for (const LinearSolver linear_solver : kLinearSolvers) {
    FactorModel model = start;
    SolverOptions options = Iterations(1);
    options.trust_region = TrustRegion::kDogleg;
    options.linear_solver = linear_solver;
    const auto solve = [&] { MakeSolver("lm_plain")->Solve(objective, options, &model); };
    if (!IsIterative(linear_solver)) {
      EXPECT_NO_THROW(solve()) << LinearSolverName(linear_solver);
      continue;
    }
    const auto error = ErrorOf(solve);
    EXPECT_THAT(error, IsError(ErrorKind::kConflict,
                               {.key = "linear_solver", .value = LinearSolverName(linear_solver)}));
    EXPECT_THAT(model.parameters(), testing::ElementsAreArray(start.parameters()));
  }
}

// An iteration with inner ones lowers E by more, and keeps to the bounds.
TEST(LmPlain, InnerIterationsGoFurther) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  double E[2];
  for (const bool inner : {false, true}) {
    FactorModel model = RandomModel(spec, 2);
    SolverOptions options = Iterations(2);
    options.inner_iterations = inner;
    E[inner ? 1 : 0] = MakeSolver("lm_plain")->Solve(objective, options, &model).final_objective;
    EXPECT_EQ(E[inner ? 1 : 0], objective.Value(model));
    EXPECT_GE(std::ranges::min(model.parameters()), 0);
  }
  EXPECT_LT(E[1], E[0]);
}

// Steps are judged otherwise, so some run goes another way; the best model is returned.
TEST(LmPlain, NonmonotonicStepsGoAnotherWay) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  for (const char* const solver : {"lm", "lm_plain"}) {
    int differ = 0;
    for (const uint64_t seed : {1, 2, 3}) {
      SolverOptions options = Iterations(20);
      FactorModel monotonic = RandomModel(spec, seed, 1), model = monotonic;
      MakeSolver(solver)->Solve(objective, options, &monotonic);
      options.nonmonotonic = true;
      const SolverSummary run = MakeSolver(solver)->Solve(objective, options, &model);
      differ += std::ranges::equal(model.parameters(), monotonic.parameters()) ? 0 : 1;
      const auto best = std::ranges::min_element(run.trace, {}, &IterationRecord::objective);
      EXPECT_EQ(run.final_objective, best->objective) << solver;
      EXPECT_EQ(objective.Value(model), best->objective) << solver;
    }
    EXPECT_GT(differ, 0) << solver;
  }
}

// A model without a single number above 0 has no derivative but that by d: only d can move.
TEST(LmPlain, LeavesZero) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(2, kGrid));
  FactorModel model(objective.spec());
  const SolverSummary run = MakeSolver("lm_plain")->Solve(objective, Iterations(20), &model);
  EXPECT_LT(run.final_objective, 0.9 * run.initial_objective);
  EXPECT_GT(std::ranges::min(model.d()), 0);
  EXPECT_EQ(std::ranges::max(model.s(0)), 0);
}

// At a stationary point Ceres finds no step, and its reason is passed on.
TEST(LmPlain, EndsWhereNothingCanMove) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(0, kGrid));
  FactorModel model(objective.spec());
  const SolverSummary run = MakeSolver("lm_plain")->Solve(objective, Iterations(1000), &model);
  EXPECT_EQ(run.stop_reason, StopReason::kNoDecrease);
  EXPECT_LT(run.iterations, 100);
  EXPECT_THAT(run.notes, testing::Contains(testing::HasSubstr("Ceres: ")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
