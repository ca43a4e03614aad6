// Every solver on the anisotropic model (paper eq. 4).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "solvers/diagnosis.h"
#include "tests/model/anisotropic_samples.h"
#include "tests/solvers/solver_kinds.h"
#include "tests/test_util.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Few nodes, so that the reference solvers take their time in a test.
ModelSpec SmallSpec(int lobes) {
  ModelSpec spec = ModelSpec::Anisotropic(lobes);
  spec.d_axis = Axis::Polar({0, 15, 30, 45}, 6);
  spec.f_axis.size = 8;
  spec.g_axis = Axis::Polar({0, 15, 30, 45}, 6);
  return spec;
}

// A ridge across the x axis.
FactorModel Cloth(const ModelSpec& spec) {
  FactorModel model = RandomModel(spec, 1, 0.1);
  for (int m = 0; m < spec.lobes; ++m) {
    const auto D = model.table(Factor::kD, m);
    for (int k = 0; k < spec.d_axis.size; ++k) {
      const double along = std::sin(spec.d_axis.Theta(k)) * std::cos(spec.d_axis.Phi(k) + m);
      D[k] *= std::exp(-std::pow(along / (0.15 + 0.15 * m), 2)) + 0.01;
    }
  }
  return model;
}

Objective NoisyObjective(const ModelSpec& spec, int num_threads = 1) {
  return {PolarSamples(Cloth(spec), 4, 6, 0.2), spec, FindWeighting("appearance"), num_threads};
}

TEST(Anisotropic, NormalEquationsAreThoseOfTheReference) {
  const ModelSpec spec = SmallSpec(2);
  const Objective objective = NoisyObjective(spec, 2);
  const FactorModel model = RandomModel(spec, 2);
  for (const Hessian hessian : {Hessian::kGaussNewton, Hessian::kNewton}) {
    QuadraticModel fast, reference;
    NormalEquations(objective).Evaluate(model, hessian, &fast);
    EvaluateReference(objective, model, hessian, &reference);
    ASSERT_EQ(fast.H.size(), reference.H.size());
    double largest = 0;
    for (const double h : reference.H) largest = std::max(largest, std::abs(h));
    for (size_t k = 0; k < fast.H.size(); ++k) {
      ASSERT_NEAR(fast.H[k], reference.H[k], 1e-12 * largest);
    }
    EXPECT_NEAR(fast.objective / reference.objective, 1, 1e-12);
  }
}

TEST(Anisotropic, AwlsIsTheReference) {
  const ModelSpec spec = SmallSpec(2);
  const Objective objective = NoisyObjective(spec);
  const FactorModel start = FindInitialModel("random").make(objective, 3);
  FactorModel fast = start, reference = start;
  const SolverOptions options{.max_iterations = 10, .relative_decrease_tolerance = 0};
  const auto fast_run = MakeSolver("awls")->Solve(objective, options, &fast);
  const auto reference_run = MakeSolver("awls_literal")->Solve(objective, options, &reference);
  ASSERT_EQ(fast_run.trace.size(), reference_run.trace.size());
  for (size_t k = 0; k < fast_run.trace.size(); ++k) {
    const double E = reference_run.trace[k].objective;
    EXPECT_NEAR(fast_run.trace[k].objective, E, 1e-9 * E) << k;
  }
  EXPECT_LT(reference_run.final_objective, 0.5 * reference_run.initial_objective);
}

TEST(Anisotropic, AwlsNeverRaisesEElementByElement) {
  const ModelSpec spec = SmallSpec(3);
  const Objective objective = NoisyObjective(spec);
  FactorModel model = FindInitialModel("random").make(objective, 4);
  double last = objective.Value(model);
  int updates = 0;
  SolverOptions options{.max_iterations = 2, .relative_decrease_tolerance = 0};
  options.on_element = [&](const FactorModel& now) {
    const double E = objective.Value(now);
    EXPECT_LE(E, last * (1 + 1e-12)) << updates;
    last = E;
    ++updates;
  };
  MakeSolver("awls")->Solve(objective, options, &model);
  EXPECT_GE(updates, 2 * 100);
}

TEST(Anisotropic, EverySolverFits) {
  const ModelSpec spec = SmallSpec(2);
  const Objective objective = NoisyObjective(spec, 2);
  const double floor = objective.Value(Cloth(spec));  // about E of the noise alone
  for (const SolverEntry& solver : kLibrarySolvers) {
    if (NeedsAGrid(solver)) continue;
    FactorModel model = FindInitialModel("highlight").make(objective, 1);
    const SolverOptions options{.max_iterations = kSanitized ? 5 : 60};
    const SolverSummary summary = solver.make()->Solve(objective, options, &model);
    EXPECT_LT(summary.final_objective, (kSanitized ? 3 : 1.25) * floor) << solver.name;
    EXPECT_NEAR(objective.Value(model) / summary.final_objective, 1, 1e-9) << solver.name;
  }
}

// Directions 15 degrees apart have few theta_d: with many bins of F the data do not tell neighbours
// apart, with few they do.
TEST(Anisotropic, SaysWhichBinsOfFTheDataLeaveOpen) {
  for (const int bins : {6, 90}) {
    ModelSpec spec = SmallSpec(1);
    spec.f_axis.size = bins;
    const Objective objective(PolarSamples(Cloth(spec), 4, 6, 0.1), spec,
                              FindWeighting("appearance"));
    const int left_open = UndeterminedByThetaD(objective);
    EXPECT_EQ(left_open > 0, bins == 90);
    FactorModel model = FindInitialModel("analytic").make(objective, 1);
    const SolverSummary summary =
        MakeSolver("newton")->Solve(objective, {.max_iterations = 3}, &model);
    EXPECT_GE(summary.diagnosis->unresolved, left_open);
    const std::string reason = std::to_string(left_open) +
                               " of them are bins of F beyond what the data's theta_d can tell";
    const bool said = std::ranges::any_of(summary.notes, [&](const std::string& note) {
      return note.find(reason) != std::string::npos;
    });
    EXPECT_EQ(said, bins == 90) << summary.FullReport();
  }
}

TEST(Anisotropic, SameBitsForAnyNumberOfThreads) {
  const ModelSpec spec = SmallSpec(2);
  for (const char* const name : {"auto", "awls", "lm"}) {
    FactorModel first;
    for (const int threads : {1, 2, 3}) {
      const Objective objective = NoisyObjective(spec, threads);
      FactorModel model = FindInitialModel("analytic").make(objective, 1);
      MakeSolver(name)->Solve(objective, {.max_iterations = 15}, &model);
      if (threads == 1) first = model;
      EXPECT_TRUE(std::ranges::equal(model.parameters(), first.parameters())) << name << threads;
    }
  }
}

// The model's own data come back from a start near it.
TEST(Anisotropic, RecoversItsOwnDataExactly) {
  const ModelSpec spec = SmallSpec(2);
  const FactorModel truth = Cloth(spec);
  const Objective objective(PolarSamples(truth, 4, 6), spec, FindWeighting("appearance"), 2);
  FactorModel model = truth;
  Random random(5);
  for (double& x : model.parameters()) x *= random.LogNormal(0.05);
  const SolverSummary summary =
      MakeSolver("newton")->Solve(objective, {.relative_decrease_tolerance = 0}, &model);
  EXPECT_LT(summary.final_objective, 1e-18 * objective.MeasuredEnergy());
}

TEST(Anisotropic, StartsAreOfTheDataAndPositive) {
  const ModelSpec spec = ModelSpec::Anisotropic(3);
  const Objective objective(UtiaSamples(Cloth(spec)), spec, FindWeighting("appearance"), 2);
  for (const InitialModel& init : InitialModels()) {
    const FactorModel model = init.make(objective, 1);
    EXPECT_LT(objective.Value(model), 30 * objective.MeasuredEnergy()) << init.name;
    for (const double x : model.parameters()) ASSERT_TRUE(std::isfinite(x) && x >= 0) << init.name;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
