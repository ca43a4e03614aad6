// A fit is the same to the last bit for any unit of the measurement and, but for Ceres' sums, for
// any number of threads and when it is repeated. Unobserved bins stay as they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "model/objective/gauge.h"
#include "tests/core/base/no_threads.h"
#include "tests/solvers/solver_kinds.h"
#include "tests/test_util.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 7, .theta_d = 6, .phi_d = 9};

SolverOptions Sweeps(int count) {
  SolverOptions options;
  options.max_iterations = count;
  options.relative_decrease_tolerance = 0;
  options.diagnose = false;  // it is slow, and not what is tested
  return options;
}

TEST(Invariance, PowersOfTwoScaleDAndSExactly) {
  const BrdfTable table = RandomTable(kGrid, 1);
  const std::vector<NamedSpec> specs = TestSpecs(kGrid);
  for (const NamedSpec& named : specs) {
    const ModelSpec& spec = named.spec;
    for (const Weighting& weighting : Weightings()) {
      if (!weighting.scale_free) continue;
      const Objective objective = MakeObjective(table, spec, weighting.name);
      for (const double scale : {0x1p150, 0x1p-150}) {
        BrdfTable scaled_table = table;
        for (auto& plane : scaled_table.stored) {
          for (double& x : plane) x = x < 0 ? x : x * scale;
        }
        const Objective scaled_objective = MakeObjective(scaled_table, spec, weighting.name);
        for (const InitialModel& init : InitialModels()) {
          if (!IsOneIn(7, {NumberOf(named, specs), NumberOf(weighting, Weightings()),
                           NumberOf(init, InitialModels())})) {
            continue;
          }
          for (const SolverEntry& solver : kLibrarySolvers) {
            // Slow: one start and scale will do.
            const bool slow = !UpdatesElements(solver);
            if (slow && (init.name != "random" || scale > 1)) continue;
            if (solver.name == "awls_gss" && spec.stretches.any()) continue;  // refused
            const std::string what = named.name + ", " + weighting.name + ", " + init.name + ", " +
                                     solver.name + ", x " + std::to_string(scale);
            FactorModel model = init.make(objective, 1);
            FactorModel scaled = init.make(scaled_objective, 1);
            const SolverSummary run = solver.make()->Solve(objective, Sweeps(3), &model);
            const SolverSummary scaled_run =
                solver.make()->Solve(scaled_objective, Sweeps(3), &scaled);
            for (double& d : model.d()) d *= scale;
            for (int m = 0; m < spec.lobes; ++m) {
              for (double& s : model.s(m)) s *= scale;
            }
            EXPECT_TRUE(std::ranges::equal(model.parameters(), scaled.parameters())) << what;
            EXPECT_EQ(scaled_run.final_objective, scale * scale * run.final_objective) << what;
          }
        }
      }
    }
  }
}

TEST(Invariance, ThreadsAndRepetition) {
  constexpr MerlGrid kMiddle{.theta_h = 20, .theta_d = 20, .phi_d = 40};
  const BrdfTable table = Synthesize(FindSynthMaterial("aluminium"), 0.1, 1, kMiddle);
  const std::vector<NamedSpec> specs = TestSpecs(kMiddle);
  for (const NamedSpec& named : specs) {
    const auto& [name, spec] = named;
    for (const SolverEntry& solver : kLibrarySolvers) {
      // Slow ones have a spec or two each.
      if (solver.name == "awls_literal" && spec.lobes > 1) continue;
      const char* const only = solver.name == "lm_plain" ? "1 lobes" : "2 lobes";
      if (!UpdatesElements(solver) && name != only) continue;
      const int iterations = solver.name == "auto" || solver.name == "multistart" ? 1 : 3;
      const Objective objective = MakeObjective(table, spec, "compressive", 1);
      FactorModel model = InitialModels().front().make(objective, 1);
      const double E = solver.make()->Solve(objective, Sweeps(iterations), &model).final_objective;
      for (const int threads : {1, 2, 3}) {
        if (UpdatesElements(solver) && !IsOneIn(3, {NumberOf(named, specs), threads})) continue;
        const std::string what =
            name + ", " + solver.name + ", " + std::to_string(threads) + " threads";
        const Objective other = MakeObjective(table, spec, "compressive", threads);
        FactorModel again = InitialModels().front().make(other, 1);
        const double other_E =
            solver.make()->Solve(other, Sweeps(iterations), &again).final_objective;
        EXPECT_NEAR(other_E, E, 1e-10 * E) << what;  // guaranteed
        if (!SameBitsForAnyThreads(solver)) continue;
        EXPECT_EQ(other_E, E) << what;  // so in fact
        EXPECT_TRUE(std::ranges::equal(again.parameters(), model.parameters())) << what;
      }
    }
  }
}

// If the system gives no thread, one does all the work.
TEST(Invariance, ThreadsThatThereAreNot) {
  const BrdfTable table = RandomTable(kGrid, 1);
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  for (const SolverEntry& solver : kLibrarySolvers) {
    const Objective objective = MakeObjective(table, spec, "appearance", 1);
    FactorModel model = InitialModels().front().make(objective, 1);
    solver.make()->Solve(objective, Sweeps(3), &model);
    const NoThreads none;
    const Objective other = MakeObjective(table, spec, "appearance", 3);
    FactorModel again = InitialModels().front().make(other, 1);
    solver.make()->Solve(other, Sweeps(3), &again);
    EXPECT_TRUE(std::ranges::equal(again.parameters(), model.parameters())) << solver.name;
  }
}

TEST(Invariance, UnobservedBinsStayAsTheyWere) {
  BrdfTable table = RandomTable(kGrid, 2);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    const int h = bin / (kGrid.theta_d * kGrid.phi_d), d = bin / kGrid.phi_d % kGrid.theta_d;
    const Cosines cosines = ToCosines(kGrid.Center(bin));
    const bool gap = h == 0 || h == 4 || d == 3 ||
                     std::min(cosines.i, cosines.o) < std::cos(DegreesToRadians(65));
    if (gap) table.stored[2][bin] = -1;
  }
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const Objective objective = MakeObjective(table, spec);
    const std::vector<bool> unobserved = UnobservedParameters(objective.coverage());
    EXPECT_EQ(std::ranges::count(unobserved, true) > 0, spec.lobes > 0);
    const FactorModel start = RandomModel(spec, 3);
    for (const SolverEntry& solver : kLibrarySolvers) {
      if (solver.name == "awls_gss" && spec.stretches.any()) continue;  // refused
      for (const double sigma : {0.0, 1.0}) {
        FactorModel model = start;
        SolverOptions options = Sweeps(3);
        options.g_filter_sigma = sigma;
        solver.make()->Solve(objective, options, &model);
        for (int k = 0; k < spec.num_parameters(); ++k) {
          if (!unobserved[k]) continue;
          EXPECT_EQ(model.parameters()[k], start.parameters()[k])
              << name << ", " << solver.name << ", parameter " << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
