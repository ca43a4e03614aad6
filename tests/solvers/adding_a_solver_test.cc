// Runs the code of docs/adding-a-solver.md, which CMake cuts out of the page: its CompassSearch is
// PageSearch here.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {

// Defined in the code of the page.
SolverEntry PageSearchEntry();
SolverSummary FitByPageSearch(const Objective& objective, FactorModel* model);

}  // namespace trilobe

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 5, .theta_d = 5, .phi_d = 8};

TEST(AddingASolver, FitsWhenRegistered) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const Objective objective = MakeObjective(TableOf(RandomModel(spec, 1), kGrid), spec);
  FactorModel model = RandomModel(spec, 2);
  const SolverSummary summary = FitByPageSearch(objective, &model);
  EXPECT_EQ(summary.solver, "page_search");
  EXPECT_LT(summary.final_objective, 0.01 * summary.initial_objective);
  EXPECT_EQ(objective.Value(model), summary.final_objective);
  for (size_t k = 1; k < summary.trace.size(); ++k) {
    const double before = summary.trace[k - 1].objective, after = summary.trace[k].objective;
    EXPECT_EQ(summary.trace[k].accepted, after < before) << k;
    EXPECT_LE(after, before) << k;
  }
  EXPECT_EQ(Solvers().back().name, "page_search");
  EXPECT_EQ(FindSolver("page_search").reference, PageSearchEntry().reference);
  EXPECT_THAT(ErrorOf([&] { RegisterSolver(PageSearchEntry()); }),
              IsError(ErrorKind::kConflict,
                      {.key = "solver", .value = "page_search"}));  // the name is taken
}

TEST(AddingASolver, HonoursLimitsAndStopsWhereNothingLowersE) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  const std::unique_ptr<Solver> solver = PageSearchEntry().make();
  const FactorModel start = RandomModel(spec, 2);
  SolverOptions options;
  options.relative_decrease_tolerance = 0;
  options.max_iterations = 3;
  FactorModel model = start;
  EXPECT_EQ(solver->Solve(objective, options, &model).stop_reason, StopReason::kMaxIterations);
  options.max_iterations = 1'000'000;
  options.max_seconds = 0;
  model = start;
  EXPECT_EQ(solver->Solve(objective, options, &model).stop_reason, StopReason::kMaxSeconds);
  EXPECT_TRUE(std::ranges::equal(model.parameters(), start.parameters()));

  // A model of d alone, whose best value the search finds to the last step.
  const ModelSpec diffuse = ModelSpec::SharedFactors(0, kGrid);
  const Objective parabolas = MakeObjective(RandomTable(kGrid, 1), diffuse);
  options.max_seconds = 60;
  model = FactorModel(diffuse);
  const SolverSummary summary = solver->Solve(parabolas, options, &model);
  EXPECT_EQ(summary.stop_reason, StopReason::kNoDecrease);
  FactorModel exact(diffuse);
  MakeSolver("awls_literal")->Solve(parabolas, {.max_iterations = 1}, &exact);
  // No step of 2^-26 d, the last that was tried, lowers E: so d is within half of it of the bottom
  // of its parabola, and of what the rounding of E hides, some sqrt(epsilon) = 1.5e-8.
  for (int c = 0; c < kChannels; ++c) {
    EXPECT_NEAR(model.d()[c], exact.d()[c], 1e-7 * exact.d()[c]) << c;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
