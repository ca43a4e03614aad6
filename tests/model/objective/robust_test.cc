#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 10};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const ModelSpec kSpec = ModelSpec::SharedFactors(2, kGrid);

// The error of a sample as the weighting sees it, by its definition.
double ErrorAt(const Objective& objective, const FactorModel& model, int j) {
  const WeightedSample sample = objective.Sample(j);
  const Weighting& weighting = objective.weighting();
  const Rgb w = weighting({sample.rho, ToCosines(objective.samples().Angles(j))});
  double square = 0;
  for (int c = 0; c < kChannels; ++c) {
    square +=
        w[c] * std::pow(UnclampedValue(model, sample.stencils, c) - sample.rho[c], 2) / kChannels;
  }
  return std::sqrt(square) / (weighting.level > 0 ? weighting.level : 1);
}

double Huber(double e, double delta) { return e <= delta ? e * e / 2 : delta * (e - delta / 2); }

// How often a sample counts in E, its solid angle included, in units of E.
double CountOf(const Objective& objective, int j) {
  const BrdfSamples& samples = objective.samples();
  const Weighting& weighting = objective.weighting();
  const Cosines cosines = ToCosines(samples.Angles(j));
  const double level = weighting.level > 0 ? weighting.level : 1;
  return samples.Multiplicity(j) * kChannels * level * level *
         weighting({samples.rho[j], cosines, samples.SolidAngle(j)})[0] /
         weighting({samples.rho[j], cosines})[0];
}

double HuberLoss(const Objective& objective, const FactorModel& model, double delta) {
  double loss = 0;
  for (int j = 0; j < objective.samples().size(); ++j) {
    loss += CountOf(objective, j) * Huber(ErrorAt(objective, model, j), delta);
  }
  return loss;
}

double MedianError(const Objective& objective, const FactorModel& model) {
  std::vector<double> errors;
  for (int j = 0; j < objective.samples().size(); ++j) {
    errors.push_back(ErrorAt(objective, model, j));
  }
  std::ranges::nth_element(errors, errors.begin() + errors.size() / 2);
  return errors[errors.size() / 2];
}

TEST(Robust, SamplesBeyondDeltaCountLess) {
  for (const char* const weighting : {"appearance", "compressive", "log_relative", "uniform"}) {
    const Objective objective = MakeObjective(RandomTable(kGrid, 1), kSpec, weighting);
    const FactorModel model = RandomModel(kSpec, 2);
    const double delta = MedianError(objective, model);
    const BrdfSamples samples = Reweighted(objective, model, delta);
    ASSERT_EQ(samples.multiplicity.size(), samples.rho.size());
    EXPECT_EQ(samples.rho, objective.samples().rho);
    EXPECT_EQ(samples.bins, objective.samples().bins);
    int beyond = 0;
    for (int j = 0; j < samples.size(); ++j) {
      const double e = ErrorAt(objective, model, j);
      if (e < delta * (1 - 1e-9)) {
        EXPECT_EQ(samples.multiplicity[j], 1) << weighting << ", sample " << j;
      } else {
        EXPECT_NEAR(samples.multiplicity[j], delta / e, 1e-9) << weighting << ", sample " << j;
        ++beyond;
      }
    }
    EXPECT_NEAR(beyond, 0.5 * samples.size(), 1) << weighting;
  }
}

TEST(Robust, AnExactFitAndALargeDeltaChangeNoWeight) {
  const FactorModel model = RandomModel(kSpec, 2);
  const Objective exact = MakeObjective(TableOf(model, kGrid), kSpec);
  const Objective other = MakeObjective(RandomTable(kGrid, 1), kSpec);
  for (const BrdfSamples& samples : {Reweighted(exact, model, 1e-6), Reweighted(other, model, 1e6),
                                     Reweighted(other, model, kInfinity)}) {
    EXPECT_EQ(samples.multiplicity, std::vector<double>(samples.rho.size(), 1.0));
  }
}

// E of the reweighted samples, halved, lies above the loss but for a constant, and touches it at
// the model: the loss changes by no more than it does.
TEST(Robust, WhatLowersItsELowersTheHuberLoss) {
  int fell = 0;
  for (const char* const weighting : {"appearance", "compressive", "log_relative", "uniform"}) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const Objective objective = MakeObjective(RandomTable(kGrid, seed), kSpec, weighting);
      const FactorModel model = RandomModel(kSpec, seed + 10);
      const double delta = 0.3 * MedianError(objective, model);
      const Objective reweighted(Reweighted(objective, model, delta), kSpec, objective.weighting());
      const double E = reweighted.Value(model), loss = HuberLoss(objective, model, delta);
      Random random(seed);
      for (int k = 0; k < 40; ++k) {
        FactorModel moved = model;
        // Small steps and large ones, of which many lead to a lower E.
        const double sigma = 0.02 * (1 + k % 10), shift = 0.05 * (k % 8 - 6);
        for (double& x : moved.parameters()) x *= std::exp(shift) * random.LogNormal(sigma);
        const double rise = reweighted.Value(moved) / 2 - E / 2;
        EXPECT_LE(HuberLoss(objective, moved, delta) - loss, rise + 1e-10 * loss)
            << weighting << ", seed " << seed << ", step " << k;
        if (rise < 0) ++fell;
      }
      // It touches: a tiny step changes both alike.
      FactorModel near = model;
      for (double& x : near.parameters()) x *= 1 - 1e-6;
      const double change = HuberLoss(objective, near, delta) - loss;
      EXPECT_NEAR(change, reweighted.Value(near) / 2 - E / 2, 1e-3 * std::abs(change)) << weighting;
    }
  }
  EXPECT_GE(fell, 100);  // so that something was tested
}

TEST(Robust, MultiplicitiesThatWereThereStayFactors) {
  BrdfSamples samples = ValidSamples(RandomTable(kGrid, 1));
  const Weighting weighting = FindWeighting("appearance");
  const FactorModel model = RandomModel(kSpec, 2);
  const Objective once(samples, kSpec, weighting);
  const double delta = MedianError(once, model);
  const std::vector<double> factor = Reweighted(once, model, delta).multiplicity;
  Random random(3);
  for (int j = 0; j < samples.size(); ++j) {
    samples.multiplicity.push_back(j % 5 == 0 ? 0 : random.Uniform(0.5, 4));
  }
  const std::vector<double> product =
      Reweighted(Objective(samples, kSpec, weighting), model, delta).multiplicity;
  for (int j = 0; j < samples.size(); ++j) {
    EXPECT_DOUBLE_EQ(product[j], samples.multiplicity[j] * factor[j]) << j;
  }
}

TEST(Robust, ScatteredSamplesCountAsTheyDoOnAGrid) {
  const BrdfSamples samples = ValidSamples(RandomTable(kGrid, 1));
  const FactorModel model = RandomModel(kSpec, 2);
  const Objective objective(Scattered(samples), kSpec, FindWeighting("compressive"));
  const double delta = MedianError(objective, model);
  const BrdfSamples reweighted = Reweighted(objective, model, delta);
  for (int j = 0; j < reweighted.size(); ++j) {
    const double expected = std::min(1.0, delta / ErrorAt(objective, model, j));
    EXPECT_NEAR(reweighted.multiplicity[j], expected, 1e-9) << j;
  }
}

TEST(Robust, TheUnitOfTheDataDoesNotMatter) {
  const BrdfTable table = RandomTable(kGrid, 1);
  const FactorModel model = RandomModel(kSpec, 2);
  const Objective objective = MakeObjective(table, kSpec, "appearance");
  const double delta = MedianError(objective, model);
  const std::vector<double> expected = Reweighted(objective, model, delta).multiplicity;
  for (const int k : {-20, -1, 3, 40}) {
    BrdfTable scaled = table;
    for (auto& plane : scaled.stored) {
      for (double& x : plane) x = x >= 0 ? std::ldexp(x, k) : x;
    }
    FactorModel brighter = model;
    for (double& x : brighter.d()) x = std::ldexp(x, k);
    for (int m = 0; m < kSpec.lobes; ++m) {
      for (double& x : brighter.s(m)) x = std::ldexp(x, k);
    }
    const Objective scaled_objective = MakeObjective(scaled, kSpec, "appearance");
    EXPECT_EQ(Reweighted(scaled_objective, brighter, delta).multiplicity, expected) << k;
  }
}

TEST(Robust, TheSameBitsForAnyNumberOfThreads) {
  const BrdfTable table = RandomTable({.theta_h = 12, .theta_d = 12, .phi_d = 180}, 1, 0);
  const ModelSpec spec = ModelSpec::SharedFactors(2, table.grid);
  const FactorModel model = RandomModel(spec, 2);
  const Objective one = MakeObjective(table, spec);
  ASSERT_GT(one.samples().size(), 1 << 14);  // more than one thread takes at once
  const double delta = MedianError(one, model);
  const std::vector<double> expected = Reweighted(one, model, delta).multiplicity;
  for (const int threads : {2, 3}) {
    const Objective parallel = MakeObjective(table, spec, "compressive", threads);
    EXPECT_EQ(Reweighted(parallel, model, delta).multiplicity, expected);
  }
}

TEST(Robust, BlackDataAndABlackModel) {
  BrdfTable black = RandomTable(kGrid, 1);
  for (auto& plane : black.stored) {
    for (double& x : plane) x = std::min(x, 0.0);
  }
  for (const char* const weighting : {"appearance", "compressive", "percentage"}) {
    const Objective objective = MakeObjective(black, kSpec, weighting);
    const BrdfSamples same = Reweighted(objective, FactorModel(kSpec), 0.1);
    EXPECT_EQ(same.multiplicity, std::vector<double>(same.rho.size(), 1.0)) << weighting;
    for (const double x : Reweighted(objective, RandomModel(kSpec, 1), 0.1).multiplicity) {
      EXPECT_GT(x, 0) << weighting;
      EXPECT_LE(x, 1) << weighting;
    }
  }
}

TEST(Robust, ADeltaThatIsNotAboveZeroIsAnError) {
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), kSpec);
  const FactorModel model = RandomModel(kSpec, 2);
  for (const double delta : {0.0, -0.0, -1.0, -kInfinity, std::nan("")}) {
    EXPECT_THAT(ErrorOf([&] { Reweighted(objective, model, delta); }),
                IsError(ErrorKind::kRange, {.key = "delta"}))
        << delta;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
