#include "fit/finish/reflectance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "fit/finish/data_edge.h"
#include "fit/prune/unmeasured_prior.h"
#include "model/objective/canonical_form.h"
#include "tests/fit/finish/fitted.h"
#include "tests/test_util.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 16, .theta_d = 12, .phi_d = 20};

// A narrow highlight on a dark ground, that gets wider or narrower along the plane of both
// directions, which a D of theta_h alone cannot follow.
BrdfTable Narrowing(double along, double max_degrees = 90, const MerlGrid& grid = kGrid) {
  ModelSpec spec = ModelSpec::SharedFactors(1, grid);
  spec.stretches = Stretch{.along = along, .across = 0};
  FactorModel model(spec);
  std::ranges::fill(model.d(), 0.01);
  for (int c = 0; c < kChannels; ++c) model.s(0)[c] = 20 * (c + 1);
  const auto D = model.table(Factor::kD, 0), G = model.table(Factor::kG, 0);
  for (int k = 0; k < spec.d_axis.size; ++k) D[k] = std::exp(-std::pow(k / 2.5, 2));
  for (int k = 0; k < spec.g_axis.size; ++k) G[k] = std::cos((k + 0.5) / spec.g_axis.size);
  for (int t = 0; t < spec.num_tables(Factor::kF); ++t) {
    std::ranges::fill(model.table(Factor::kF, t), 0.5);
  }
  BrdfTable table = TableOf(model, grid);
  LimitAngles(DegreesToRadians(max_degrees), Unmeasured::kBeyondMaxAngle, &table);
  return table;
}

FactorModel Fitted(const Objective& objective) {
  FactorModel model = trilobe::Fitted(objective, 40);
  Canonicalize(objective, &model);
  return model;
}

Objective ObjectiveOf(const BrdfTable& table, int num_threads = 1) {
  return MakeObjective(table, ModelSpec::SharedFactors(1, table.grid), "log_relative", num_threads);
}

TableLayout Full(const FactorModel& model) { return TableLayout::Full(model.spec()); }

// The same, written down for all samples.
Reflectance OfAllSamples(const Objective& objective, const FactorModel& model) {
  const BrdfSamples& samples = objective.samples();
  const std::vector<Rgb> values = EvaluateSamples(model, samples, 1);
  Reflectance sum;
  double through = 0;
  for (int j = 0; j < samples.size(); ++j) {
    const Cosines cosines = samples.CosinesOf(j);
    const double a = samples.SolidAngle(j) * cosines.i * cosines.o;
    through += a;
    for (int c = 0; c < kChannels; ++c) {
      sum.measured[c] += a * samples.rho[j][c];
      sum.fitted[c] += a * values[j][c];
    }
  }
  for (int c = 0; c < kChannels; ++c) {
    sum.measured[c] /= through;
    sum.fitted[c] /= through;
  }
  return sum;
}

TEST(Reflectance, IsTheMeanByCosinesAndSolidAngle) {
  const Objective objective = ObjectiveOf(Narrowing(-2));
  const FactorModel model = Fitted(objective);
  const Reflectance expected = OfAllSamples(objective, model),
                    reflectance = ReflectanceOf(objective, model);
  double squares = 0, of_measured = 0;
  for (int c = 0; c < kChannels; ++c) {
    EXPECT_NEAR(reflectance.measured[c], expected.measured[c], 1e-12 * expected.measured[c]);
    EXPECT_NEAR(reflectance.fitted[c], expected.fitted[c], 1e-12 * expected.fitted[c]);
    squares += std::pow(expected.fitted[c] - expected.measured[c], 2);
    of_measured += std::pow(expected.measured[c], 2);
  }
  EXPECT_NEAR(reflectance.Error(), std::sqrt(squares / of_measured), 1e-10);
}

// A large objective is judged by every n-th sample, which tells by how much a model is off.
TEST(Reflectance, SomeSamplesStandForAll) {
  constexpr MerlGrid kFine{.theta_h = 60, .theta_d = 60, .phi_d = 90};
  const Objective objective = ObjectiveOf(Narrowing(-1, 80, kFine));
  ASSERT_GT(objective.samples().size(), 3 << 16);
  FactorModel model(objective.spec());
  std::ranges::fill(model.parameters(), 1.0);
  const auto D = model.table(Factor::kD, 0);
  for (int k = 0; k < objective.spec().d_axis.size; ++k) D[k] = std::exp(-k / 3.0);
  const Reflectance expected = OfAllSamples(objective, model),
                    reflectance = ReflectanceOf(objective, model);
  for (int c = 0; c < kChannels; ++c) {
    EXPECT_NEAR(reflectance.fitted[c] / reflectance.measured[c],
                expected.fitted[c] / expected.measured[c],
                2e-3 * expected.fitted[c] / expected.measured[c]);
  }
}

// Light that a fit loses, since it cannot follow a highlight, comes back at a small rise of E.
TEST(Reflectance, ComesBackForLittleOfE) {
  for (const double along : {-1.0, 0.7}) {
    const Objective objective = ObjectiveOf(Narrowing(along));
    const FactorModel fitted = Fitted(objective);
    const double E = objective.Value(fitted), error = ReflectanceOf(objective, fitted).Error();
    ASSERT_GT(error, 0.012) << along;
    const std::optional<MatchedModel> matched =
        MatchReflectance(objective, objective, fitted, Full(fitted), 30);
    ASSERT_TRUE(matched) << along;
    CheckParameters(matched->model);
    const double after = ReflectanceOf(objective, matched->model).Error();
    EXPECT_LT(after, 0.6 * error) << along;
    EXPECT_LT(objective.Value(matched->model) + 30 * E * after * after,
              (1 + 30 * error * error) * E)
        << along;
    // At the end neither more nor less light would lower this sum.
    const auto slope_by_s = [&](const FactorModel& at) {
      constexpr double kStep = 1e-4;
      double total[2];
      for (const int k : {0, 1}) {
        FactorModel moved = at;
        for (double& s : moved.s(0)) s *= k == 0 ? 1 - kStep : 1 + kStep;
        const double off = ReflectanceOf(objective, moved).Error();
        total[k] = objective.Value(moved) + 30 * E * off * off;
      }
      return (total[1] - total[0]) / (2 * kStep);
    };
    EXPECT_LT(std::abs(slope_by_s(matched->model)), 0.05 * std::abs(slope_by_s(fitted))) << along;
  }
}

TEST(Reflectance, OfAGoodFitIsLeftAsItIs) {
  const Objective objective = ObjectiveOf(Narrowing(0));
  const FactorModel fitted = Fitted(objective);
  EXPECT_LT(ReflectanceOf(objective, fitted).Error(), 0.01);
  EXPECT_FALSE(MatchReflectance(objective, objective, fitted, Full(fitted), 30));
}

TEST(Reflectance, OfABlackMeasurementIsRight) {
  BrdfTable table = Narrowing(0);
  for (auto& plane : table.stored) std::ranges::fill(plane, 0.0);
  const Objective objective = ObjectiveOf(table);
  FactorModel model(objective.spec());
  std::ranges::fill(model.parameters(), 1.0);
  EXPECT_EQ(ReflectanceOf(objective, model).Error(), 0);
  EXPECT_FALSE(MatchReflectance(objective, objective, model, Full(model), 30));
}

TEST(Reflectance, TiedEntriesStayTied) {
  const Objective objective = ObjectiveOf(Narrowing(-2, 70));
  FactorModel model = Fitted(objective);
  ASSERT_TRUE(TieEntriesAtDataEdge(objective, &model));
  Canonicalize(objective, &model);
  const TableLayout untied = UntiedEntries(objective.coverage(), model);
  const int tied = Full(model).num_parameters(model.spec()) - untied.num_parameters(model.spec());
  ASSERT_GT(tied, 0);
  std::optional<MatchedModel> matched = MatchReflectance(objective, objective, model, untied, 30);
  ASSERT_TRUE(matched);
  Canonicalize(objective, &matched->model);
  EXPECT_EQ(UntiedEntries(objective.coverage(), matched->model), untied);
}

// Samples besides the data hold the model in the directions that they cover.
TEST(Reflectance, AGuideHoldsWhatItSpeaksOf) {
  const BrdfTable table = Narrowing(-2, 60);
  const Objective objective =
      MakeObjective(table, ModelSpec::SharedFactors(1, kGrid), "appearance");
  FactorModel fitted = Fitted(objective);
  ASSERT_TRUE(TieEntriesAtDataEdge(objective, &fitted));  // or it would undershoot 0 there
  Canonicalize(objective, &fitted);
  const Objective with_prior = UnmeasuredPrior(objective, fitted).JoinTo(objective);
  // Squares of what it says of directions that were not measured, now less then, weighted.
  const auto change = [&](const FactorModel& model) {
    return with_prior.Value(model) - objective.Value(model);
  };
  const TableLayout full = Full(fitted);
  const std::optional<MatchedModel> alone =
      MatchReflectance(objective, objective, fitted, full, 30);
  const std::optional<MatchedModel> held =
      MatchReflectance(objective, with_prior, fitted, full, 30);
  ASSERT_TRUE(alone && held);
  EXPECT_EQ(held->error_before, alone->error_before);
  EXPECT_LT(held->error_after, 0.8 * held->error_before);
  EXPECT_LT(change(held->model), 0.25 * change(alone->model));
}

TEST(Reflectance, StopsBeforeAStepAndAgreesForAnyNumberOfThreads) {
  const BrdfTable table = Narrowing(-2);
  const Objective objective = ObjectiveOf(table);
  const FactorModel fitted = Fitted(objective);
  EXPECT_FALSE(
      MatchReflectance(objective, objective, fitted, Full(fitted), 30, [] { return true; }));
  const std::optional<MatchedModel> one =
      MatchReflectance(objective, objective, fitted, Full(fitted), 30);
  const Objective three_threads = ObjectiveOf(table, 3);
  const std::optional<MatchedModel> three =
      MatchReflectance(three_threads, three_threads, fitted, Full(fitted), 30);
  ASSERT_TRUE(one && three);
  EXPECT_TRUE(std::ranges::equal(one->model.parameters(), three->model.parameters()));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
