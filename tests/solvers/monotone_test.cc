// No solver raises E, from one iteration to the next; nor do AWLS and its relatives in a single
// update of an element or block.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/solvers/solver_kinds.h"
#include "tests/test_util.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 12};

BrdfTable Scaled(BrdfTable table, double by) {
  for (auto& plane : table.stored) {
    for (double& x : plane) x *= by;
  }
  return table;
}

BrdfTable Constant(const Rgb& rho) {
  BrdfTable table = MakeInvalidTable("constant", kGrid);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    for (int c = 0; c < kChannels; ++c) table.SetValue(c, bin, rho[c]);
  }
  return table;
}

BrdfTable MakeTable(const std::string& kind) {
  if (kind == "random") return RandomTable(kGrid, 1);
  if (kind == "noisy") {  // a model's own values, times noise
    BrdfTable table = TableOf(RandomModel(ModelSpec::SharedFactors(3, kGrid), 2, 0.2), kGrid);
    Random random(3);
    for (auto& plane : table.stored) {
      for (double& x : plane) x *= random.LogNormal(0.1);
    }
    return table;
  }
  if (kind == "spiky") {
    BrdfTable table = RandomTable(kGrid, 4);
    for (const int bin : {31, 210, 211, 340}) table.stored[bin % 3][bin] = 1e6 * 1500;
    return table;
  }
  if (kind == "wide") return RandomTable(kGrid, 1, 0.2, 3);  // five orders of magnitude
  if (kind == "tiny") return Scaled(RandomTable(kGrid, 5), 1e-12);
  if (kind == "huge") return Scaled(RandomTable(kGrid, 6), 1e12);
  if (kind == "constant") return Constant({0.3, 0.2, 0.1});
  if (kind == "black") return Constant({0, 0, 0});
  BrdfTable table = RandomTable(kGrid, 7);
  if (kind == "channel_zero") {
    std::ranges::replace_if(
        table.stored[1], [](double x) { return x > 0; }, 0);
  }
  if (kind == "single_bin") {
    table = MakeInvalidTable("single", kGrid);
    for (int c = 0; c < kChannels; ++c) table.SetValue(c, kGrid.Index(2, 3, 4), 0.1 + c);
  }
  return table;
}

class Monotone : public testing::TestWithParam<const char*> {};

TEST_P(Monotone, EveryUpdate) {
  const BrdfTable table = MakeTable(GetParam());
  const std::vector<NamedSpec> specs = {
      {"3 lobes", ModelSpec::SharedFactors(3, kGrid)},
      {"independent G", ModelSpec::IndependentG(kGrid)},
      TestSpecs(kGrid)[8],  // G a channel, shared by the lobes; F a lobe
  };
  for (const NamedSpec& named : specs) {
    const ModelSpec& spec = named.spec;
    for (const Weighting& weighting : Weightings()) {
      const Objective objective = MakeObjective(table, spec, weighting.name);
      for (const InitialModel& init : InitialModels()) {
        const bool first = &weighting == &Weightings().front() && &init == &InitialModels().front();
        const bool is_picked =
            IsOneIn(9, {NumberOf(named, specs), NumberOf(weighting, Weightings()),
                        NumberOf(init, InitialModels())});
        if (!first && !is_picked) continue;
        for (const SolverEntry& solver : kLibrarySolvers) {
          // Joint steps are judged by E as a whole: one of each kind of data and spec will do.
          if (!ReportsUpdates(solver) && !first) continue;
          const std::string what =
              named.name + ", " + weighting.name + ", " + init.name + ", " + solver.name;
          FactorModel model = init.make(objective, 1);
          // The rounding error of E where the fit is exact: every residual off by a few roundings
          // of the measured value.
          constexpr double kError = 4 * std::numeric_limits<double>::epsilon();
          const double floor = kError * kError * objective.MeasuredEnergy();
          double before = objective.Value(model), worst = 0;
          int updates = 0, raised = 0, bad = 0;
          SolverOptions options;
          options.max_iterations = 6;
          options.relative_decrease_tolerance = 0;
          options.diagnose = false;
          const auto look = [&](const FactorModel& now) {
            const double after = objective.Value(now);
            if (!(after <= before * (1 + 1e-12) + floor)) {
              ++raised;
              worst = std::max(worst, (after - before) / before);
            }
            before = after;
            for (const double x : now.parameters()) bad += !(std::isfinite(x) && x >= 0);
          };
          options.on_element = [&](const FactorModel& now) {
            ++updates;
            look(now);
          };
          options.on_iteration = [&](const IterationRecord&, const FactorModel& now) {
            look(now);
            return true;
          };
          const SolverSummary summary = solver.make()->Solve(objective, options, &model);
          if (UpdatesElements(solver)) {
            EXPECT_EQ(updates, summary.iterations * spec.num_parameters()) << what;
          } else {
            EXPECT_EQ(updates > 0, summary.iterations > 0 && ReportsUpdates(solver)) << what;
          }
          EXPECT_EQ(raised, 0) << what << ": by up to " << worst << " of it";
          EXPECT_EQ(bad, 0) << what;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Data, Monotone,
                         testing::Values("random", "noisy", "spiky", "wide", "constant", "tiny",
                                         "huge", "black", "channel_zero", "single_bin"),
                         [](const auto& param) { return param.param; });

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
