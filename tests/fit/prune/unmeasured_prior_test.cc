#include "fit/prune/unmeasured_prior.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 30, .theta_d = 30, .phi_d = 60};

ModelSpec Spec() { return ModelSpec::SharedFactors(2, kGrid); }

// A material of which nothing was measured beyond 60 degrees.
Objective Measured(int num_threads = 1) {
  BrdfTable table = TableOf(RandomModel(Spec(), 1), kGrid);
  LimitAngles(DegreesToRadians(60), Unmeasured::kBeyondMaxAngle, &table);
  return MakeObjective(table, Spec(), "appearance", num_threads);
}

TEST(UnmeasuredPrior, SpeaksWhereNothingWasMeasuredAndLittle) {
  const Objective objective = Measured();
  const BrdfSamples& measured = objective.samples();
  const FactorModel model = RandomModel(Spec(), 2);
  const Objective with_prior = UnmeasuredPrior(objective, model).JoinTo(objective);
  EXPECT_EQ(with_prior.spec(), objective.spec());
  EXPECT_EQ(with_prior.weighting().level, objective.weighting().level);
  const BrdfSamples& both = with_prior.samples();
  const std::set<int> own(measured.bins.begin(), measured.bins.end());
  const BrdfTable said = Reconstruct(model, "model", kGrid);
  Rgb most{};
  for (const Rgb& rho : measured.rho) {
    for (int c = 0; c < kChannels; ++c) most[c] = std::max(most[c], rho[c]);
  }
  int j = 0;
  double times = 0;
  for (int k = 0; k < both.size(); ++k) {
    if (own.contains(both.bins[k])) {
      ASSERT_EQ(both.bins[k], measured.bins[j]);  // all of them, in their order
      EXPECT_EQ(both.rho[k], measured.rho[j++]);
      EXPECT_EQ(both.multiplicity[k], 1);
      continue;
    }
    times += both.multiplicity[k];
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_DOUBLE_EQ(both.rho[k][c], std::min(said.Value(c, both.bins[k]), 100 * most[c]));
    }
  }
  EXPECT_EQ(j, measured.size());
  EXPECT_LT(both.size() - measured.size(), measured.size());
  const std::vector<bool> above = BinsAboveSurface(kGrid);
  const auto unmeasured = std::ranges::count(above, true) - measured.size();
  EXPECT_NEAR(times / static_cast<double>(unmeasured), 0.01, 0.002);
}

// An entry that a large set reads by the prior alone is read in a small one, too: it could not run
// away there.
TEST(UnmeasuredPrior, SaysTheSameInEveryObjective) {
  const Objective objective = Measured();
  const UnmeasuredPrior prior(objective, RandomModel(Spec(), 2));
  const Objective few(Thinned(objective.samples(), 7), Spec(), objective.weighting());
  const auto said = [&](const Objective& objective) {
    const Objective with_prior = prior.JoinTo(objective);
    std::set<int> bins(with_prior.samples().bins.begin(), with_prior.samples().bins.end());
    for (const int bin : objective.samples().bins) bins.erase(bin);
    return bins;
  };
  EXPECT_FALSE(said(objective).empty());
  EXPECT_EQ(said(few), said(objective));
}

TEST(UnmeasuredPrior, SpeaksBeyondScatteredSamplesAndVeryLittle) {
  BrdfSamples scattered = Scattered(Measured().samples());
  for (const HalfDiffAngles& at : scattered.angles) {
    scattered.directions.push_back(ToSphericalAngles(ToDirections(at)));
  }
  const Objective objective(scattered, Spec(), FindWeighting("appearance"));
  const FactorModel model = RandomModel(Spec(), 2);
  const BrdfSamples both = UnmeasuredPrior(objective, model).JoinTo(objective).samples();
  ASSERT_GT(both.size(), scattered.size());
  double times = 0;
  for (int j = 0; j < both.size(); ++j) {
    const SphericalAngles& at = both.directions[j];
    EXPECT_EQ(j >= scattered.size(),
              std::max(at.theta_i, at.theta_o) > DegreesToRadians(60) + 1e-9);
    if (j >= scattered.size()) times += both.multiplicity[j];
  }
  EXPECT_LT(times, 0.001 * scattered.size());
  EXPECT_GT(times, 0.0001 * scattered.size());
}

TEST(UnmeasuredPrior, IsSilentWhereAllWasMeasuredOrDirectionsAreNotKnown) {
  const FactorModel model = RandomModel(Spec(), 2);
  const Objective whole = MakeObjective(TableOf(RandomModel(Spec(), 1), kGrid), Spec());
  EXPECT_EQ(UnmeasuredPrior(whole, model).JoinTo(whole).samples().size(), whole.samples().size());
  BrdfSamples scattered = Scattered(Measured().samples());
  const Objective objective(scattered, Spec(), FindWeighting("appearance"));
  EXPECT_EQ(UnmeasuredPrior(objective, model).JoinTo(objective).samples().size(), scattered.size());
}

// G so rough that its spline undershoots, and factors whose product overflows.
TEST(UnmeasuredPrior, SaysNothingThatNoMeasurementCouldSay) {
  const Objective objective = Measured();
  FactorModel model = RandomModel(Spec(), 2);
  for (int k = 0; k < Spec().g_axis.size; ++k) {
    model.table(Factor::kG, 0)[k] = model.table(Factor::kG, 1)[k] = k % 3 == 0 ? 1 : 0;
  }
  std::ranges::fill(model.d(), 0.0);
  const auto rho = UnclampedSamples(model, objective.samples(), 1);
  EXPECT_TRUE(std::ranges::any_of(rho, [](const Rgb& x) { return x[0] < 0; }));
  const auto expect_valid = [&] {
    const Objective with_prior = UnmeasuredPrior(objective, model).JoinTo(objective);
    EXPECT_GT(with_prior.samples().size(), objective.samples().size());
    EXPECT_TRUE(std::isfinite(with_prior.Value(RandomModel(Spec(), 3))));
  };
  expect_valid();
  // D is so large at the largest theta_h that its samples have no value.
  model.table(Factor::kD, 0)[kGrid.theta_h - 1] = 1e308;
  model.s(0)[0] = 1e10;
  expect_valid();
  // No sample of the prior has a value.
  std::ranges::fill(model.table(Factor::kD, 0), 1e308);
  EXPECT_EQ(UnmeasuredPrior(objective, model).JoinTo(objective).samples().size(),
            objective.samples().size());
}

// A sample that counts several times goes on to do so.
TEST(UnmeasuredPrior, KeepsHowOftenSamplesCount) {
  BrdfSamples samples = Measured().samples();
  samples.multiplicity.assign(samples.size(), 1);
  for (int j = 0; j < samples.size(); ++j) samples.multiplicity[j] += j % 4;
  const Objective objective(samples, Spec(), FindWeighting("appearance"));
  const BrdfSamples both =
      UnmeasuredPrior(objective, RandomModel(Spec(), 2)).JoinTo(objective).samples();
  int j = 0;
  for (int k = 0; k < both.size() && j < samples.size(); ++k) {
    if (both.bins[k] == samples.bins[j]) {
      EXPECT_EQ(both.multiplicity[k], samples.multiplicity[j++]);
    }
  }
  EXPECT_EQ(j, samples.size());
}

TEST(UnmeasuredPrior, TheSameBitsForAnyNumberOfThreads) {
  const FactorModel model = RandomModel(Spec(), 2);
  const Objective one = Measured(1), three = Measured(3);
  const BrdfSamples a = UnmeasuredPrior(one, model).JoinTo(one).samples();
  const BrdfSamples b = UnmeasuredPrior(three, model).JoinTo(three).samples();
  EXPECT_EQ(a.bins, b.bins);
  EXPECT_EQ(a.rho, b.rho);
  EXPECT_EQ(a.multiplicity, b.multiplicity);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
