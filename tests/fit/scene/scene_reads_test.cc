#include "fit/scene/scene_reads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/base/quantile.h"
#include "tests/test_util.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/model/objective/weighting.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 12, .theta_d = 12, .phi_d = 24};

double SumOfShares(const std::vector<BinShare>& shares) {
  double sum = 0;
  for (const BinShare& share : shares) sum += share.share;
  return sum;
}

// The values that a model has at the bins of a grid.
BrdfSamples SamplesOfModel(const FactorModel& model) {
  return ValidSamples(Reconstruct(model, "model", kGrid, 1));
}

DirectionHistogram CountsOf(const std::vector<double>& counts) { return {"counts", kGrid, counts}; }

TEST(BinsAround, SharesAreThoseOfLinearInterpolationInBothOrders) {
  const HalfDiffAngles center = kGrid.Center(3, 4, 5), next = kGrid.Center(4, 5, 6);
  const HalfDiffAngles at = {center.theta_h, (3 * center.theta_d + next.theta_d) / 4,
                             (center.phi_d + next.phi_d) / 2};
  const std::vector<BinShare> shares = BinsAround(kGrid, at);
  EXPECT_NEAR(SumOfShares(shares), 1, 1e-12);
  std::vector<double> of_bin(kGrid.size(), 0.0);
  for (const BinShare& share : shares) of_bin[share.bin] += share.share;
  for (const int p : {5, 6, 17, 18}) {
    EXPECT_NEAR(of_bin[kGrid.Index(3, 4, p)], 0.75 / 4, 1e-12) << p;
    EXPECT_NEAR(of_bin[kGrid.Index(3, 5, p)], 0.25 / 4, 1e-12) << p;
  }
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const HalfDiffAngles any = {random.Uniform(0, kPi / 2), random.Uniform(0, kPi / 2),
                                random.Uniform(0, kPi)};
    EXPECT_NEAR(SumOfShares(BinsAround(kGrid, any)), 1, 1e-12);
  }
}

// A bin that a scene reads twice as often counts twice, whatever its solid angle.
TEST(UsedSamples, CountsTakeThePlaceOfSolidAngles) {
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(1, kGrid), 1);
  const BrdfSamples all = SamplesOfModel(model);
  std::vector<double> counts(kGrid.size(), 0.0);
  counts[all.bins[0]] = 1;
  counts[all.bins.back()] = 2;
  const BrdfSamples used = UsedSamples(all, CountsOf(counts));
  ASSERT_EQ(used.size(), 2);
  EXPECT_NE(all.SolidAngle(0), all.SolidAngle(all.size() - 1));
  EXPECT_EQ(used.SolidAngle(0), used.SolidAngle(1));
  EXPECT_EQ(used.Multiplicity(1), 2 * used.Multiplicity(0));
  EXPECT_TRUE(Selected(used, {1}).counted);
  const Weighting weighting = ForSamples(FindWeighting("appearance"), all);
  const Objective objective(used, model.spec(), weighting);
  for (int j = 0; j < 2; ++j) {
    const Rgb weight = weighting({used.rho[j], used.CosinesOf(j), 1});
    EXPECT_EQ(objective.Sample(j).weight[0], used.Multiplicity(j) * weight[0]);
  }
  EXPECT_NEAR(
      objective.MeasuredEnergy(),
      [&] {
        double energy = 0;
        for (int j = 0; j < 2; ++j) {
          for (int c = 0; c < kChannels; ++c) {
            energy += objective.Sample(j).weight[c] * used.rho[j][c] * used.rho[j][c];
          }
        }
        return energy;
      }(),
      1e-12 * objective.MeasuredEnergy());  // folded grids add up otherwise
}

TEST(SceneReads, ANoisyMeasurementOfAModelIsHardlyOff) {
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(1, kGrid), 2);
  BrdfSamples all = SamplesOfModel(model);
  Random random(3);
  for (Rgb& rho : all.rho) {
    for (double& x : rho) x *= 1 + 0.05 * (2 * random.Uniform() - 1);
  }
  std::vector<double> counts(kGrid.size(), 0.0);
  for (const int bin : all.bins) counts[bin] = random.Uniform() < 0.1 ? 1 : 0;
  const DirectionHistogram histogram = CountsOf(counts);
  const BrdfSamples used = UsedSamples(all, histogram);
  const double by_place = SceneReads(all, used, histogram).Compare(model, 1).mean_delta_e;
  const double each = CompareSamples(used, EvaluateSamples(model, used, 1)).mean_delta_e;
  EXPECT_LT(by_place, 0.5 * each);
  EXPECT_GT(by_place, 0);
}

// An error counts by how often it is read.
TEST(SceneReads, WeighByReads) {
  const FactorModel truth = RandomModel(ModelSpec::SharedFactors(0, kGrid), 4);
  FactorModel off = truth;
  for (double& d : off.d()) d *= 1.2;
  const BrdfSamples all = SamplesOfModel(truth);
  const DirectionList list = {{{0.2, 0.3, 0.4}, {0.7, 0.1, 2.0}}};
  const BrdfSamples used = UsedSamples(all, list);
  const SceneReads reads(all, used, list);
  EXPECT_EQ(reads.Compare(truth, 1).mean_delta_e, 0);
  EXPECT_GT(reads.Compare(off, 1).mean_delta_e, 1);
  // Two patches, one of which is off.
  std::vector<SeenPatch> patches(
      2, {.measured = {0.2, 0.2, 0.2}, .fitted = {0.2, 0.2, 0.2}, .cosines = {1, 1}, .weight = 3});
  patches[1].fitted = {0.3, 0.3, 0.3};
  const double even = ComparePatches(patches).mean_delta_e;
  patches[1].weight = 1;
  EXPECT_NEAR(ComparePatches(patches).mean_delta_e, even / 2, 1e-9);
}

TEST(WeightedQuantile, IsThatOfRepeatedValues) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<double> values, weights, repeated;
    for (int k = 0; k < 20; ++k) {
      values.push_back(random.Uniform());
      weights.push_back(1 + static_cast<int>(3 * random.Uniform()));
      repeated.insert(repeated.end(), static_cast<size_t>(weights.back()), values.back());
    }
    const double low = Quantile(&repeated, 0.85), high = Quantile(&repeated, 1);
    const double quantile = WeightedQuantile(values, weights, 0.95);
    EXPECT_GE(quantile, low);
    EXPECT_LE(quantile, high);
    const std::vector<double> ones(values.size(), 1.0);
    std::vector<double> same = values;
    EXPECT_EQ(WeightedQuantile(values, ones, 0.95), Quantile(&same, 0.95));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
