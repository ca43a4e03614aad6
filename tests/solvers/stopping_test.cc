#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <string>
#include <thread>

#include "tests/solvers/iterations.h"
#include "tests/solvers/solver_kinds.h"
#include "tests/test_util.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};

// Every test runs on every solver.
class Stopping : public testing::TestWithParam<std::string> {
 protected:
  Stopping()
      : objective_(MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(2, kGrid))) {}

  FactorModel Start() const { return FindInitialModel("constant").make(objective_, 1); }

  // Runs, and checks what holds of every run.
  SolverSummary Run(const SolverOptions& options, FactorModel* model) const {
    return Run(objective_, options, model);
  }
  static SolverSummary Run(const Objective& objective, const SolverOptions& options,
                           FactorModel* model) {
    const double E0 = objective.Value(*model);
    SolverSummary summary = MakeSolver(GetParam())->Solve(objective, options, model);
    EXPECT_EQ(summary.solver, GetParam());
    EXPECT_EQ(static_cast<int>(summary.trace.size()), summary.iterations + 1);
    EXPECT_EQ(summary.trace.front().objective, E0);
    EXPECT_EQ(summary.initial_objective, E0);
    double least = E0;
    for (size_t k = 0; k < summary.trace.size(); ++k) {
      const IterationRecord& record = summary.trace[k];
      EXPECT_EQ(record.iteration, static_cast<int>(k));
      EXPECT_EQ(record.filtered,
                k > 0 && options.g_filter_sigma > 0 && FiltersG(FindSolver(GetParam())));
      if (k > 0) {
        EXPECT_GE(record.seconds, summary.trace[k - 1].seconds);
      }
      least = std::min(least, record.objective);
    }
    EXPECT_GE(summary.trace.front().seconds, 0);
    EXPECT_GE(summary.seconds, summary.trace.back().seconds);
    EXPECT_EQ(summary.final_objective, least);
    EXPECT_EQ(objective.Value(*model), least);
    return summary;
  }

  Objective objective_;
};

TEST_P(Stopping, AfterMaxIterations) {
  for (const int count : {0, 1, 7}) {
    FactorModel model = Start();
    SolverOptions options;
    options.max_iterations = count;
    options.relative_decrease_tolerance = kNever;
    const SolverSummary summary = Run(options, &model);
    EXPECT_EQ(summary.stop_reason, StopReason::kMaxIterations);
    EXPECT_EQ(summary.iterations, count);
    if (count == 0) {
      EXPECT_TRUE(std::ranges::equal(model.parameters(), Start().parameters()));
    }
  }
}

TEST_P(Stopping, AfterMaxSeconds) {
  // Iterations so slow that no processor is through before.
  constexpr double kSeconds = 0.004;
  FactorModel model = Start();
  SolverOptions options;
  options.relative_decrease_tolerance = kNever;
  options.max_iterations = std::numeric_limits<int>::max();
  options.on_iteration = [](const IterationRecord&, const FactorModel&) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kSeconds / 2));
    return true;
  };
  options.max_seconds = 0;
  EXPECT_EQ(Run(options, &model).iterations, 0);
  options.max_seconds = kSeconds;
  const SolverSummary summary = Run(options, &model);
  EXPECT_EQ(summary.stop_reason, StopReason::kMaxSeconds);
  EXPECT_GE(summary.seconds, kSeconds);
  for (size_t k = 0; k + 1 < summary.trace.size(); ++k) {
    EXPECT_LT(summary.trace[k].seconds, kSeconds);
  }
}

TEST_P(Stopping, AtTheFirstSmallDecrease) {
  FactorModel model = Start();
  SolverOptions options;
  options.relative_decrease_tolerance = 0.01;
  const SolverSummary summary = Run(options, &model);
  EXPECT_EQ(summary.stop_reason, StopReason::kConverged);
  ASSERT_GE(summary.trace.size(), 3U);
  for (size_t k = 1; k < summary.trace.size(); ++k) {
    const double before = summary.trace[k - 1].objective;
    const double decrease = (before - summary.trace[k].objective) / before;
    const bool last = k + 1 == summary.trace.size();
    if (!summary.trace[k].accepted) continue;        // a step taken back is no sign of convergence
    if (!summary.starts.empty() && !last) continue;  // nor is it one that others are behind
    EXPECT_EQ(decrease < 0.01, last) << k;
  }
}

TEST_P(Stopping, WhenACallbackSaysSo) {
  for (const int stop_at : {0, 1, 3}) {
    FactorModel model = Start();
    std::vector<IterationRecord> seen;
    SolverOptions options;
    options.relative_decrease_tolerance = kNever;
    options.on_iteration = [&](const IterationRecord& record, const FactorModel& now) {
      EXPECT_EQ(objective_.Value(now), record.objective);
      seen.push_back(record);
      return record.iteration != stop_at;
    };
    const SolverSummary summary = Run(options, &model);
    EXPECT_EQ(summary.stop_reason, StopReason::kInterrupted);
    EXPECT_EQ(summary.iterations, stop_at);
    EXPECT_EQ(seen, summary.trace);
  }
}

// No more than an iteration after it has been asked.
TEST_P(Stopping, WhenItIsAskedTo) {
  FactorModel model = Start();
  int iterations = 0;
  SolverOptions options;
  options.relative_decrease_tolerance = kNever;
  options.on_iteration = [&](const IterationRecord& record, const FactorModel&) {
    iterations = record.iteration;
    return true;
  };
  options.stop = [&] { return iterations >= 2; };
  const SolverSummary summary = Run(options, &model);
  EXPECT_EQ(summary.stop_reason, StopReason::kInterrupted);
  EXPECT_EQ(summary.iterations, 2);
  EXPECT_FALSE(summary.diagnosis);
}

TEST_P(Stopping, AtAnExactFit) {
  for (const bool black : {false, true}) {
    // Lambertian data are an exact fit of a model whose lobes are dark.
    const ModelSpec spec = objective_.spec();
    FactorModel truth(spec);
    if (!black) std::ranges::copy(Rgb{0.3, 0.2, 0.1}, truth.d().begin());
    const Objective objective = MakeObjective(TableOf(truth, kGrid), spec);
    FactorModel model = truth;
    for (double& d : model.d()) d *= 2;
    SolverOptions options;
    options.relative_decrease_tolerance = kNever;
    const SolverSummary summary = MakeSolver(GetParam())->Solve(objective, options, &model);
    EXPECT_EQ(summary.stop_reason, StopReason::kExactFit);
    if (black) {
      EXPECT_EQ(summary.iterations, 0);
    } else if (UpdatesElements(FindSolver(GetParam()))) {
      EXPECT_EQ(summary.iterations, 1);
    } else {  // damped steps close in on it
      EXPECT_LE(summary.iterations, 10);
    }
    EXPECT_LE(summary.final_objective, 1e-30 * objective.MeasuredEnergy());
  }
}

// The filter may raise E; the best of the recorded models is returned all the same. Here G is rough
// in truth, so that smoothing it does harm.
class Filtering : public Stopping {};

TEST_P(Filtering, TheFilterMayRaiseEButNotTheResult) {
  const FactorModel truth = RandomModel(objective_.spec(), 2);
  const Objective objective = MakeObjective(TableOf(truth, kGrid), truth.spec());
  FactorModel start = truth;
  for (double& s : start.s(0)) s *= 1.01;
  SolverOptions options;
  options.max_iterations = 5;
  options.relative_decrease_tolerance = kNever;

  FactorModel plain = start, filtered = start;
  const SolverSummary plain_run = Run(objective, options, &plain);
  options.g_filter_sigma = 1;
  const SolverSummary filtered_run = Run(objective, options, &filtered);
  EXPECT_LT(plain_run.final_objective, 0.1 * plain_run.initial_objective);
  EXPECT_GT(filtered_run.trace.back().objective, 10 * filtered_run.initial_objective);
  EXPECT_EQ(filtered_run.final_objective, filtered_run.initial_objective);
  EXPECT_TRUE(std::ranges::equal(filtered.parameters(), start.parameters()));
}

std::vector<std::string> SolverNames(bool (*wanted)(const SolverEntry&)) {
  std::vector<std::string> names;
  for (const SolverEntry& solver : kLibrarySolvers) {
    if (wanted(solver)) names.push_back(solver.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Solvers, Stopping,
                         testing::ValuesIn(SolverNames([](const SolverEntry&) { return true; })),
                         [](const auto& param) { return param.param; });
INSTANTIATE_TEST_SUITE_P(Solvers, Filtering, testing::ValuesIn(SolverNames(FiltersG)),
                         [](const auto& param) { return param.param; });

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
