#include "fit/prune/prune.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "model/objective/gauge.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Smooth tables; lobes with very different D and G, since two with the same G are one.
FactorModel Material(int lobes, bool grey) {
  FactorModel model(ModelSpec::SharedFactors(lobes, kGrid));
  const ModelSpec& spec = model.spec();
  const auto colour = [&](int c) { return grey ? 1 : 1 + 0.5 * c; };
  for (int c = 0; c < kChannels; ++c) {
    model.d()[c] = 0.1 * colour(c);
    if (lobes == 0) continue;
    const auto F = model.table(Factor::kF, c);
    for (int k = 0; k < spec.f_axis.size; ++k) {
      F[k] = 0.3 / colour(c) + std::pow((k + 0.5) / spec.f_axis.size, 4);
    }
  }
  constexpr double kWidths[] = {1, 3, 7};
  for (int m = 0; m < lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) model.s(m)[c] = (m + 1) * colour(grey ? 0 : c);
    const auto D = model.table(Factor::kD, m), G = model.table(Factor::kG, m);
    for (int k = 0; k < spec.d_axis.size; ++k) {
      D[k] = std::exp(-std::pow(k / kWidths[m], 2)) / kWidths[m];
    }
    for (int k = 0; k < spec.g_axis.size; ++k) {
      G[k] = std::cos((k + 0.5) / spec.g_axis.size * (0.2 + 0.6 * m));
    }
  }
  return model;
}

// Each value multiplied by log-normal noise.
BrdfTable Noisy(BrdfTable table, double sigma, uint64_t seed) {
  Random random(seed);
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    for (int c = 0; c < kChannels; ++c) {
      const double noise = random.LogNormal(sigma);
      if (table.Value(c, bin) >= 0) table.SetValue(c, bin, table.Value(c, bin) * noise);
    }
  }
  return table;
}

// A measurement, and a model fitted to it.
struct Fit {
  Fit(const BrdfTable& measured, int lobes, int iterations)
      : objective(MakeObjective(measured, ModelSpec::SharedFactors(lobes, kGrid))),
        model(InitialModels().front().make(objective, 1)) {
    MakeSolver("varpro")->Solve(objective, {.max_iterations = iterations, .diagnose = false},
                                &model);
    Canonicalize(objective.coverage(), &model, LobeOrder::kAsTheyAre);
  }
  const Objective objective;
  FactorModel model;
};

Fit MakeFit(const BrdfTable& measured, int lobes, int iterations = 30) {
  return {measured, lobes, iterations};
}
Fit MakeFit(const FactorModel& material, double sigma = 0.01, uint64_t seed = 1) {
  return MakeFit(Noisy(TableOf(material, kGrid), sigma, seed), 3);
}

// The model is what its stored parameters say, and E what they give.
void ExpectConsistent(const Fit& fit, const PrunedModel& pruned) {
  FactorModel expanded = pruned.model;
  ExpandStored(pruned.layout, &expanded);
  EXPECT_TRUE(std::ranges::equal(expanded.parameters(), pruned.model.parameters()));
  EXPECT_EQ(pruned.num_parameters, pruned.layout.num_parameters(pruned.model.spec()));
  const Objective own(fit.objective.samples(), pruned.model.spec(), fit.objective.weighting());
  EXPECT_EQ(pruned.E, own.Value(pruned.model));
}

// With N = 2000 values and p parameters the E of a fit is about 1 - p / N times that of the truth.
// So what the 86 parameters of three lobes more than needed gain of the noise is 4 %: with 10 % to
// spend they go, and what the material has and one number more or less is not enough for stays.
const PruneOptions kGenerous{.max_relative_rise = 0.1};

TEST(Prune, OneLobeStaysOne) {
  const Fit fit = MakeFit(Material(1, false));
  const PrunedModel pruned = Prune(fit.objective, fit.model, kGenerous);
  EXPECT_EQ(pruned.model.spec().lobes, 1);
  ExpectConsistent(fit, pruned);
}

TEST(Prune, ALambertianKeepsNone) {
  const Fit fit = MakeFit(Material(0, false));
  const PrunedModel pruned = Prune(fit.objective, fit.model, kGenerous);
  EXPECT_EQ(pruned.model.spec().lobes, 0);
  EXPECT_EQ(pruned.num_parameters, 3);
  ExpectConsistent(fit, pruned);
}

TEST(Prune, ThreeDistinctLobesStayThree) {
  const Fit fit = MakeFit(Material(3, false), 0.001);
  const PrunedModel pruned = Prune(fit.objective, fit.model, kGenerous);
  EXPECT_EQ(pruned.model.spec().lobes, 3);
  EXPECT_LT(pruned.num_parameters, fit.model.spec().num_parameters());
  ExpectConsistent(fit, pruned);
}

// Pruning goes on from the stored entries of a model that is thinned already.
TEST(Prune, GoesOnFromWhatIsStored) {
  const Fit fit = MakeFit(Material(2, false));
  const PrunedModel once = Prune(fit.objective, fit.model, {.max_relative_rise = 0.01});
  ASSERT_GT(once.model.spec().lobes, 1);
  const Objective objective(fit.objective, once.model.spec());
  PruneOptions options{.max_relative_rise = 0, .layout = once.layout};
  const PrunedModel same = Prune(objective, once.model, options);
  EXPECT_EQ(same.num_parameters, once.num_parameters);
  EXPECT_NEAR(same.E, once.E, 1e-12 * once.E);
  // Also with fewer lobes: each table of D then has nodes of one or two earlier ones.
  options.max_relative_rise = 1e6;
  options.colour = options.shadowing = false;
  const PrunedModel further = Prune(objective, once.model, options);
  EXPECT_LT(further.model.spec().lobes, once.model.spec().lobes);
  std::vector<int> before;
  for (const auto& nodes : once.layout.nodes[static_cast<int>(Factor::kD)]) {
    before.insert(before.end(), nodes.begin(), nodes.end());
  }
  for (const auto& nodes : further.layout.nodes[static_cast<int>(Factor::kD)]) {
    EXPECT_THAT(before, testing::IsSupersetOf(nodes));
  }
  ExpectConsistent(fit, further);
}

TEST(Prune, AGreyOneKeepsOneChannel) {
  const Fit fit = MakeFit(Material(2, true));
  const PrunedModel pruned = Prune(fit.objective, fit.model, kGenerous);
  EXPECT_FALSE(pruned.layout.coloured_d);
  EXPECT_FALSE(pruned.layout.coloured_s);
  EXPECT_FALSE(pruned.model.spec().F.per_channel);
  ExpectConsistent(fit, pruned);
}

TEST(Prune, ColourStays) {
  const Fit fit = MakeFit(Material(1, false));
  const PrunedModel pruned = Prune(fit.objective, fit.model, kGenerous);
  EXPECT_TRUE(pruned.layout.coloured_d);
  EXPECT_TRUE(pruned.model.spec().F.per_channel);
}

TEST(Prune, NeverOverrunsTheBudget) {
  for (const double sigma : {0.0, 0.02, 0.3}) {
    for (uint64_t seed = 1; seed <= 2; ++seed) {
      const BrdfTable measured = sigma > 0.2
                                     ? RandomTable(kGrid, seed)
                                     : Noisy(TableOf(Material(2, false), kGrid), sigma, seed);
      const Fit fit = MakeFit(measured, 2, /*iterations=*/3);  // not at its minimum
      const double E = fit.objective.Value(fit.model);
      for (const double rise : {0.0, 1e-4, 0.01, 0.5}) {
        const PrunedModel pruned = Prune(fit.objective, fit.model, {.max_relative_rise = rise});
        EXPECT_LE(pruned.E, E * (1 + rise) * (1 + 1e-12)) << sigma << " " << seed << " " << rise;
        EXPECT_LE(pruned.num_parameters, fit.model.spec().num_parameters());
        ExpectConsistent(fit, pruned);
      }
    }
  }
}

TEST(Prune, NeverLosesMorePsnrThanItMay) {
  const Fit fit = MakeFit(Material(2, false), 0.02);
  const double psnr = ScoreModel(fit.objective, fit.model).psnr_db;
  for (const double drop : {0.05, 0.5, 3.0}) {
    const PrunedModel pruned =
        Prune(fit.objective, fit.model, {.max_relative_rise = kInfinity, .max_psnr_drop_db = drop});
    const Objective own(fit.objective.samples(), pruned.model.spec(), fit.objective.weighting());
    EXPECT_GE(ScoreModel(own, pruned.model).psnr_db, psnr - drop);
    EXPECT_LT(pruned.num_parameters, fit.model.spec().num_parameters());
  }
}

TEST(Prune, ABudgetOfNumbersIsMet) {
  const Fit fit = MakeFit(Material(2, false), 0.02);
  double E = 0;
  for (const int parameters : {90, 50, 20, 8, 1}) {
    const PrunedModel pruned = Prune(fit.objective, fit.model, {.max_parameters = parameters});
    EXPECT_LE(pruned.num_parameters, parameters);
    EXPECT_GE(pruned.E, E) << parameters;  // fewer parameters reach no less
    E = pruned.E;
    ExpectConsistent(fit, pruned);
  }
}

TEST(Prune, ABudgetOfZeroChangesNothing) {
  const Fit fit = MakeFit(Material(2, false), 0.02);
  const PrunedModel pruned = Prune(fit.objective, fit.model, {.max_relative_rise = 0});
  const double E = fit.objective.Value(fit.model);
  EXPECT_NEAR(pruned.E, E, 1e-12 * E);
  EXPECT_EQ(pruned.model.spec(), fit.model.spec());
}

TEST(Prune, WhatIsFreeGoesAtABudgetOfZero) {
  // No data above the sixth theta_d, a lobe that reflects nothing, and equal channels.
  const BrdfTable all = TableOf(Material(1, true), kGrid);
  BrdfTable measured = MakeInvalidTable("part", kGrid);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    if (all.Value(0, bin) < 0 || bin / kGrid.phi_d % kGrid.theta_d >= 6) continue;
    for (int c = 0; c < kChannels; ++c) measured.SetValue(c, bin, all.Value(c, bin));
  }
  Fit fit = MakeFit(measured, 2, 2);
  // Scales are those that Prune will set, so that equal channels stay equal to the bit.
  NormalizeScale(fit.objective.coverage(), &fit.model);
  for (const Factor factor : {Factor::kF}) {
    for (int c = 1; c < kChannels; ++c) {
      std::ranges::copy(fit.model.table(factor, 0), fit.model.table(factor, c).begin());
    }
  }
  std::ranges::fill(fit.model.d(), 0.1);
  std::ranges::fill(fit.model.s(0), 0.2);
  std::ranges::fill(fit.model.s(1), 0.0);
  const PrunedModel pruned = Prune(fit.objective, fit.model, {.max_relative_rise = 0});
  EXPECT_EQ(pruned.model.spec().lobes, 1);
  EXPECT_FALSE(pruned.layout.coloured_d);
  EXPECT_FALSE(pruned.layout.coloured_s);
  ASSERT_EQ(pruned.model.spec().num_tables(Factor::kF), 1);
  EXPECT_LE(pruned.layout.of(Factor::kF, 0).back(), 5);
  const double E = fit.objective.Value(fit.model);
  EXPECT_NEAR(pruned.E, E, 1e-12 * E);
}

TEST(Prune, EverySwitchLeavesItsPartAlone) {
  const Fit fit = MakeFit(Material(1, true));  // everything could go
  const ModelSpec& spec = fit.model.spec();
  PruneOptions options = kGenerous;
  options.lobes = false;
  EXPECT_EQ(Prune(fit.objective, fit.model, options).model.spec().lobes, 3);
  options = kGenerous;
  options.colour = false;
  PrunedModel pruned = Prune(fit.objective, fit.model, options);
  EXPECT_TRUE(pruned.layout.coloured_d && pruned.layout.coloured_s);
  EXPECT_TRUE(pruned.model.spec().F.per_channel);
  options = kGenerous;
  options.shadowing = false;
  pruned = Prune(fit.objective, fit.model, options);
  EXPECT_EQ(pruned.model.spec().G, spec.G);
  for (const auto& nodes : pruned.layout.nodes[2]) EXPECT_EQ(nodes.size(), spec.g_axis.size);
  options = kGenerous;
  options.tables = false;
  pruned = Prune(fit.objective, fit.model, options);
  for (const auto& nodes : pruned.layout.nodes[0]) EXPECT_EQ(nodes.size(), spec.d_axis.size);
  for (const auto& nodes : pruned.layout.nodes[1]) EXPECT_EQ(nodes.size(), spec.f_axis.size);
  options.lobes = options.colour = options.shadowing = false;
  pruned = Prune(fit.objective, fit.model, options);
  EXPECT_EQ(pruned.num_parameters, spec.num_parameters());
  for (int k = 0; k < spec.num_parameters(); ++k) {
    const double fitted = fit.model.parameters()[k];  // which canonical form rounds a few times
    EXPECT_NEAR(pruned.model.parameters()[k], fitted, 1e-14 * fitted);
  }
}

TEST(Prune, SharesOnlyWhatItMay) {
  // One that would share all of G.
  FactorModel model = Material(2, /*grey=*/false);
  std::ranges::copy(model.table(Factor::kG, 0), model.table(Factor::kG, 1).begin());
  const Objective objective = MakeObjective(Noisy(TableOf(model, kGrid), 0.01, 1), model.spec());
  PruneOptions options;
  options.lobes = false;
  options.max_parameters = 40;
  EXPECT_FALSE(Prune(objective, model, options).model.spec().G.per_lobe);
  options.sharing = false;
  const PrunedModel pruned = Prune(objective, model, options);
  EXPECT_EQ(pruned.model.spec(), model.spec());
  EXPECT_LE(pruned.num_parameters, 40);
}

TEST(Prune, AddsALobeWhereTheBudgetAsksForALowerE) {
  const BrdfTable measured = Noisy(TableOf(Material(2, false), kGrid), 0.01, 1);
  const Fit fit = MakeFit(measured, 1);
  const double E = fit.objective.Value(fit.model);
  const PrunedModel more =
      Prune(fit.objective, fit.model, {.max_relative_rise = -0.3, .max_lobes = 3});
  EXPECT_GE(more.model.spec().lobes, 2);
  EXPECT_LE(more.E, 0.7 * E);
  ExpectConsistent(fit, more);
  const PrunedModel none = Prune(fit.objective, fit.model, {.max_relative_rise = -0.3});
  EXPECT_EQ(none.model.spec().lobes, 1);
  EXPECT_FALSE(more.misses_budget);
  EXPECT_TRUE(none.misses_budget);
  ASSERT_FALSE(none.decisions.empty());
  EXPECT_FALSE(none.decisions.front().taken);
  EXPECT_LE(none.E, 1.1 * E);
  EXPECT_LT(none.num_parameters, fit.model.spec().num_parameters());
}

TEST(Prune, TheSameBitsForAnyNumberOfThreads) {
  const BrdfTable measured = Noisy(TableOf(Material(2, false), kGrid), 0.02, 1);
  const Fit fit = MakeFit(measured, 3);
  const Objective parallel(fit.objective.samples(), fit.objective.spec(), fit.objective.weighting(),
                           3);
  const PrunedModel a = Prune(fit.objective, fit.model, kGenerous);
  const PrunedModel b = Prune(parallel, fit.model, kGenerous);
  EXPECT_EQ(a.layout, b.layout);
  EXPECT_EQ(a.E, b.E);
  EXPECT_TRUE(std::ranges::equal(a.model.parameters(), b.model.parameters()));
}

TEST(Prune, OtherSharingAndScatteredSamples) {
  for (const NamedSpec& named : TestSpecs(kGrid)) {
    if (kSanitized && named.spec.lobes > 2) continue;
    const Objective objective = MakeObjective(RandomTable(kGrid, 1), named.spec);
    FactorModel model = RandomModel(named.spec, 1);
    const double E = objective.Value(model);
    const PrunedModel pruned = Prune(objective, model, {});
    EXPECT_LE(pruned.E, 1.01 * E) << named.name;
  }
  const BrdfSamples samples =
      Scattered(ValidSamples(Noisy(TableOf(Material(1, false), kGrid), 0.02, 1)));
  const Objective objective(samples, ModelSpec::SharedFactors(1, kGrid),
                            FindWeighting("compressive"));
  FactorModel model = InitialModels().front().make(objective, 1);
  MakeSolver("newton")->Solve(objective, {.max_iterations = 10, .diagnose = false}, &model);
  const PrunedModel pruned = Prune(objective, model, {});
  EXPECT_LE(pruned.E, 1.01 * objective.Value(model));
  EXPECT_LT(pruned.num_parameters, model.spec().num_parameters());
}

TEST(Prune, DegenerateMeasurements) {
  BrdfTable black = RandomTable(kGrid, 1);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    for (int c = 0; c < kChannels; ++c) {
      if (black.Value(c, bin) >= 0) black.SetValue(c, bin, 0);
    }
  }
  const BrdfTable spiky = RandomTable(kGrid, 1, /*lost=*/0.6, /*sigma=*/10);
  for (const BrdfTable& measured : {black, spiky}) {
    const Fit fit = MakeFit(measured, 2, 5);
    const double E = fit.objective.Value(fit.model);
    const PrunedModel pruned = Prune(fit.objective, fit.model, {});
    EXPECT_LE(pruned.E, 1.01 * E);
    EXPECT_LE(Prune(fit.objective, fit.model, {.max_parameters = 10}).num_parameters, 10);
    // A random model, which is no fit at all.
    FactorModel far = RandomModel(fit.model.spec(), 1, 3);
    EXPECT_LE(Prune(fit.objective, far, {}).E, 1.01 * fit.objective.Value(far));
  }
}

TEST(Prune, BadBudgets) {
  const Fit fit = MakeFit(Material(0, false));
  for (const PruneOptions& options : {PruneOptions{.max_relative_rise = std::nan("")},
                                      {.max_psnr_drop_db = std::nan("")},
                                      {.max_parameters = 0}}) {
    EXPECT_THAT(ErrorOf([&] { Prune(fit.objective, fit.model, options); }),
                IsError(ErrorKind::kRange, {.key = "budget"}));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
