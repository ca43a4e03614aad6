// Inputs that no measurement has, and starts that nobody would choose: no solver crashes, hangs,
// makes E worse or leaves the parameters that a model may have.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/solvers/solver_kinds.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 5, .theta_d = 5, .phi_d = 8};

struct NamedSamples {
  std::string name;
  BrdfSamples samples;
};

std::vector<NamedSamples> TestSamples() {
  const BrdfTable random = RandomTable(kGrid, 1);
  BrdfTable single = MakeInvalidTable("single", kGrid), black = random, one_channel = random;
  for (int c = 0; c < kChannels; ++c) single.SetValue(c, kGrid.Index(1, 2, 3), 0.1 + c);
  for (int c = 0; c < kChannels; ++c) {
    for (double& x : black.stored[c]) x = std::min(x, 0.0);
    if (c == 1) continue;
    for (double& x : one_channel.stored[c]) x = std::min(x, 0.0);
  }
  std::vector<NamedSamples> all = {{"random", ValidSamples(random)},
                                   {"single", ValidSamples(single)},
                                   {"black", ValidSamples(black)},
                                   {"one channel", ValidSamples(one_channel)}};
  for (size_t k = 0; k < 2; ++k) {
    all.push_back({all[k].name + ", scattered", Scattered(all[k].samples)});
  }
  return all;
}

struct NamedModel {
  std::string name;
  FactorModel model;
};

std::vector<NamedModel> TestStarts(const ModelSpec& spec) {
  FactorModel ones(spec), dark = RandomModel(spec, 2), blank = dark, huge = dark;
  std::ranges::fill(ones.parameters(), 1.0);
  for (int m = 0; m < spec.lobes; m += 2) std::ranges::fill(dark.s(m), 0.0);
  for (const Factor factor : kFactors) {
    if (spec.lobes > 0) std::ranges::fill(blank.table(factor, 0), 0.0);
  }
  for (double& x : huge.parameters()) x *= 1e12;
  return {{"nothing", FactorModel(spec)},
          {"all equal", ones},
          {"dark lobes", dark},
          {"blank tables", blank},
          {"huge", huge}};
}

class Degenerate : public testing::TestWithParam<std::string> {};

TEST_P(Degenerate, LeavesAModelThatIsNoWorse) {
  std::vector<NamedSpec> specs = {{"0 lobes", ModelSpec::SharedFactors(0, kGrid)},
                                  {"1 lobe", ModelSpec::SharedFactors(1, kGrid)}};
  for (const NamedSpec& named : TestSpecs(kGrid)) {
    if (named.name == "D shared by all" || named.name == "nothing shared") specs.push_back(named);
  }
  int solved = 0;
  const std::vector<NamedSamples> all_samples = TestSamples();
  for (const NamedSamples& of_data : all_samples) {
    const auto& [data, samples] = of_data;
    if (!samples.on_grid() && NeedsAGrid(FindSolver(GetParam()))) continue;
    for (const NamedSpec& of_shape : specs) {
      const auto& [shape, spec] = of_shape;
      const Objective objective(samples, spec, FindWeighting("compressive"));
      const std::vector<NamedModel> starts = TestStarts(spec);
      for (const NamedModel& of_start : starts) {
        if (kSanitized && !IsOneIn(3, {NumberOf(of_data, all_samples), NumberOf(of_shape, specs),
                                       NumberOf(of_start, starts)})) {
          continue;
        }
        const auto& [name, start] = of_start;
        const std::string what = data + ", " + shape + ", from " + name;
        FactorModel model = start;
        SolverOptions options;
        options.max_iterations = 8;
        options.relative_decrease_tolerance = 0;
        options.starts = 4;
        const SolverSummary summary = MakeSolver(GetParam())->Solve(objective, options, &model);
        ++solved;
        EXPECT_LE(summary.final_objective, objective.Value(start)) << what;
        EXPECT_EQ(summary.final_objective, objective.Value(model)) << what;
        EXPECT_LE(summary.iterations, 8) << what;
        for (const StartResult& tried : summary.starts) {
          EXPECT_TRUE(std::isfinite(tried.objective)) << what << ", " << tried.name;
        }
        ASSERT_TRUE(summary.diagnosis) << what;
        EXPECT_TRUE(std::isfinite(summary.diagnosis->optimality)) << what;
        const auto bad = [](double x) { return !(std::isfinite(x) && x >= 0); };
        EXPECT_EQ(std::ranges::count_if(model.parameters(), bad), 0) << what;
        for (int k = 0; k < spec.num_parameters(); ++k) {
          if (objective.coverage()[k] > 0) continue;
          EXPECT_EQ(model.parameters()[k], start.parameters()[k]) << what << ", parameter " << k;
        }
      }
    }
  }
  EXPECT_GT(solved, 0);
}

std::vector<std::string> SolverNames() {
  std::vector<std::string> names;
  for (const SolverEntry& solver : Solvers()) names.push_back(solver.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Solvers, Degenerate, testing::ValuesIn(SolverNames()),
                         [](const auto& param) { return param.param; });

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
