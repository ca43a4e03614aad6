// awls_block and awls_accelerated: what they promise beyond what every solver does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "model/objective/gauge.h"
#include "solvers/sums/cell_sums.h"
#include "tests/error_of.h"
#include "tests/solvers/iterations.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};

// The parameters of each block, in the order of CellSums::UpdateBlocks.
std::vector<std::vector<int>> Blocks(const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  std::vector<std::vector<int>> blocks;
  for (int c = 0; c < kChannels; ++c) {
    blocks.emplace_back();
    for (int m = -1; m < spec.lobes; ++m) blocks.back().push_back(kChannels * (1 + m) + c);
  }
  for (const Factor factor : {Factor::kD, Factor::kF}) {
    const int groups = spec.sharing(factor).per_channel ? kChannels : 1;
    if (spec.lobes == 0) continue;
    for (int k = 0; k < spec.table_size(factor); ++k) {
      for (int c = 0; c < groups; ++c) {
        blocks.emplace_back();
        for (int t = c; t < spec.num_tables(factor); t += groups) {
          blocks.back().push_back(model.TableOffset(factor, t) + k);
        }
      }
    }
  }
  return blocks;
}

TEST(CellBlocks, StandWhereNoOtherPlaceIsBetter) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    if (spec.stretches.any()) continue;  // D is not constant in a cell then
    const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
    FactorModel model = RandomModel(spec, 2);
    CellSums sums(*objective.folded(), spec);
    sums.Accumulate(model, 1);
    const std::vector<std::vector<int>> blocks = Blocks(model);
    size_t next = 0;
    double before = objective.Value(model);
    Random random(3);
    sums.UpdateBlocks(
        before, 2,
        [&, &name = name](const FactorModel& now) {
          ASSERT_LT(next, blocks.size()) << name;
          const std::vector<int>& block = blocks[next++];
          const double E = objective.Value(now);
          EXPECT_LE(E, before * (1 + 1e-12)) << name << ", block " << next - 1;
          before = E;
          FactorModel other = now;
          for (const double size : {1e-3, 0.1, 1.0, 10.0}) {
            for (int trial = 0; trial < 4; ++trial) {
              for (const int k : block) {
                const double moved = now.parameters()[k] + size * random.Normal();
                other.parameters()[k] = std::max(moved, 0.0);
              }
              EXPECT_GE(objective.Value(other), E * (1 - 1e-11)) << name << ", block " << next - 1;
            }
          }
        },
        &model);
    EXPECT_EQ(next, blocks.size()) << name;
  }
}

// b is carried along from block to block: after all of them it is what a pass over the data gives.
TEST(CellBlocks, KeepTheSums) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    if (spec.stretches.any()) continue;  // D is not constant in a cell then
    const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
    FactorModel model = RandomModel(spec, 2);
    CellSums sums(*objective.folded(), spec), fresh(*objective.folded(), spec);
    sums.Accumulate(model, 1);
    double largest = 0;
    const auto each = [&](const auto& visit) {
      for (int h = 0; h < kGrid.theta_h; ++h) {
        for (int d = 0; d < kGrid.theta_d; ++d) {
          for (int c = 0; c < kChannels; ++c) {
            for (int a = 0; a < sums.basis(); ++a) visit(h, d, c, a);
          }
        }
      }
    };
    each([&](int h, int d, int c, int a) {
      largest = std::max(largest, std::abs(sums.b(h, d, c)[a]));
    });
    const double E = objective.Value(model);
    for (int k = 0; k < 3; ++k) sums.UpdateBlocks(E, 1, nullptr, &model);
    fresh.Accumulate(model, 1);
    each([&, &name = name](int h, int d, int c, int a) {
      EXPECT_NEAR(sums.b(h, d, c)[a], fresh.b(h, d, c)[a], 1e-11 * largest) << name;
    });
  }
}

// No block moves where no element can: with bounds on single parameters only, a minimum along each
// one is a minimum of the convex whole.
TEST(CellBlocks, StayAtAFixedPointOfElements) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  FactorModel model = RandomModel(spec, 2);
  CellSums sums(*objective.folded(), spec);
  for (int k = 0; k < 20; ++k) {
    sums.Accumulate(model, 1);
    for (int j = 0; j < 1000; ++j) sums.UpdateAll(nullptr, &model);
  }
  const FactorModel before = model;
  const double E = objective.Value(model);
  sums.UpdateBlocks(E, 1, nullptr, &model);
  EXPECT_NEAR(objective.Value(model), E, 1e-12 * E);
  for (size_t k = 0; k < model.parameters().size(); ++k) {
    const double x = before.parameters()[k];
    EXPECT_NEAR(model.parameters()[k], x, 1e-6 * (x + 0.01)) << k;
  }
}

// Their first sweeps are those of AWLS: runs are longer than that.
class AwlsRelatives : public testing::TestWithParam<const char*> {};

TEST_P(AwlsRelatives, SameBitsForAnyThreads) {
  constexpr MerlGrid kMiddle{.theta_h = 20, .theta_d = 20, .phi_d = 40};
  const BrdfTable table = Synthesize(FindSynthMaterial("aluminium"), 0.1, 1, kMiddle);
  for (const auto& [name, spec] : TestSpecs(kMiddle)) {
    std::vector<double> expected;
    for (const int threads : {1, 2, 3}) {
      const Objective objective = MakeObjective(table, spec, "compressive", threads);
      FactorModel model = InitialModels().front().make(objective, 1);
      MakeSolver(GetParam())->Solve(objective, Iterations(kSanitized ? 5 : 7), &model);
      if (threads == 1) expected.assign(model.parameters().begin(), model.parameters().end());
      EXPECT_TRUE(std::ranges::equal(model.parameters(), expected)) << name << ", " << threads;
    }
  }
}

TEST_P(AwlsRelatives, PowersOfTwoScaleExactly) {
  constexpr double kScale = 0x1p10;
  const BrdfTable table = RandomTable(kGrid, 1);
  BrdfTable scaled_table = table;
  for (auto& plane : scaled_table.stored) {
    for (double& x : plane) x = x < 0 ? x : x * kScale;
  }
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const auto solve = [&, &spec = spec](const BrdfTable& table) {
      const Objective objective = MakeObjective(table, spec, "uniform");
      FactorModel model = InitialModels().front().make(objective, 1);
      return MakeSolver(GetParam())->Solve(objective, Iterations(8), &model);
    };
    EXPECT_EQ(solve(scaled_table).final_objective, kScale * kScale * solve(table).final_objective)
        << name;
  }
}

// Data of the model's own form are fitted exactly, as by AWLS, and the tables come back.
TEST_P(AwlsRelatives, RecoverATruth) {
  const ModelSpec spec = ModelSpec::SharedFactors(3, kGrid);
  const FactorModel truth = RandomModel(spec, 5, 0.7);
  const Objective objective = MakeObjective(TableOf(truth, kGrid), spec);
  FactorModel model = truth;
  Random random(5);
  for (double& x : model.parameters()) x *= random.LogNormal(0.1);
  const SolverSummary summary = MakeSolver(GetParam())->Solve(objective, Iterations(2000), &model);
  EXPECT_LE(summary.final_objective, 1e-12 * summary.initial_objective);
  FactorModel expected = truth;
  Canonicalize(objective.coverage(), &expected);
  Canonicalize(objective.coverage(), &model);
  for (size_t k = 0; k < expected.parameters().size(); ++k) {
    const double x = expected.parameters()[k];
    EXPECT_NEAR(model.parameters()[k], x, 1e-4 * x) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(AwlsBlock, AwlsRelatives,
                         testing::Values("awls_block", "awls_accelerated"),
                         [](const auto& param) { return param.param; });

// Smooth lobes resemble each other: the hard case for moving one number at a time. Twice the sweeps
// of AWLS are more than the extra work.
TEST(AwlsAccelerated, OutrunsAwls) {
  constexpr MerlGrid kMiddle{.theta_h = 20, .theta_d = 20, .phi_d = 40};
  for (const char* const material : {"plastic", "chrome"}) {
    const BrdfTable table = Synthesize(FindSynthMaterial(material), 0.02, 1, kMiddle);
    const Objective objective = MakeObjective(table, ModelSpec::SharedFactors(3, kMiddle));
    const auto E_after = [&](const std::string& solver, int iterations) {
      FactorModel model = InitialModels().front().make(objective, 1);
      return MakeSolver(solver)->Solve(objective, Iterations(iterations), &model).final_objective;
    };
    const double block = E_after("awls_block", 60);
    EXPECT_LT(block, E_after("awls", 60)) << material;
    EXPECT_LT(E_after("awls_accelerated", 60), std::min(block, E_after("awls", 120))) << material;
  }
}

// The claim is that of docs/decisions/sweeps.md.
TEST(AwlsBlock, BeginsWithThreeSweepsOfAwls) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 2), spec);
  const auto fitted = [&](const char* solver, int iterations) {
    FactorModel model = RandomModel(spec, 2);
    MakeSolver(solver)->Solve(objective, Iterations(iterations), &model);
    return std::vector<double>(model.parameters().begin(), model.parameters().end());
  };
  EXPECT_EQ(fitted("awls_block", 3), fitted("awls", 3));
  EXPECT_NE(fitted("awls_block", 4), fitted("awls", 4));
}

TEST(AwlsAccelerated, WithoutMemoryIsAwlsBlock) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  SolverOptions options = Iterations(10);
  options.memory = 0;
  FactorModel block = RandomModel(spec, 1), accelerated = block;
  MakeSolver("awls_block")->Solve(objective, options, &block);
  MakeSolver("awls_accelerated")->Solve(objective, options, &accelerated);
  EXPECT_TRUE(std::ranges::equal(accelerated.parameters(), block.parameters()));
  options.memory = -1;
  EXPECT_THAT(
      ErrorOf([&] { MakeSolver("awls_accelerated")->Solve(objective, options, &accelerated); }),
      IsError(ErrorKind::kRange, {.key = "memory", .value = "-1"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
