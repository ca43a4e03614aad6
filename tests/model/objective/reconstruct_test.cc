#include "trilobe/model/objective/reconstruct.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/error_of.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid = {.theta_h = 12, .theta_d = 10, .phi_d = 16};

FactorModel RandomModel(const ModelSpec& spec) {
  FactorModel model(spec);
  std::mt19937_64 random(7);
  for (double& x : model.parameters()) x = static_cast<double>(random() >> 11) * 0x1p-53;
  return model;
}

TEST(ReconstructTest, EqualsTheStencilsAtEveryBin) {
  for (const ModelSpec& spec :
       {ModelSpec::SharedFactors(0, kGrid), ModelSpec::SharedFactors(3, kGrid),
        ModelSpec::SharedFactors(8, kGrid), ModelSpec::IndependentG(kGrid)}) {
    const FactorModel model = RandomModel(spec);
    const BrdfTable table = Reconstruct(model, "test", kGrid);
    const std::vector<bool> above = BinsAboveSurface(kGrid);
    for (int bin = 0; bin < kGrid.size(); ++bin) {
      for (int c = 0; c < kChannels; ++c) {
        if (!above[bin]) {
          ASSERT_EQ(table.stored[c][bin], -1);
          continue;
        }
        const double expected =
            std::max(UnclampedValue(model, GridStencils(spec, kGrid, bin), c), 0.0);
        ASSERT_NEAR(table.Value(c, bin), expected, 1e-12 * (1 + expected)) << bin;
      }
    }
  }
}

TEST(ReconstructTest, InterpolatesOnAGridThatIsNotTheSpecs) {
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(2, kGrid));
  const MerlGrid finer = {.theta_h = 17, .theta_d = 10, .phi_d = 16};
  const BrdfTable table = Reconstruct(model, "test", finer);
  const int bin = finer.Index(4, 3, 5);
  const Rgb expected = Evaluate(model, ToDirections(finer.Center(bin)));
  for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(table.Value(c, bin), expected[c], 1e-9);
}

// Catmull-Rom undershoots beside a peak, so G, and with it the model, can be negative.
TEST(ReconstructTest, IsNeverNegative) {
  FactorModel model(ModelSpec::SharedFactors(1, kGrid));
  for (double& x : model.parameters()) x = 1;
  for (double& d : model.d()) d = 0;
  for (double& g : model.table(Factor::kG, 0)) g = 0;
  model.table(Factor::kG, 0)[5] = 1;
  BrdfSamples samples{"test", kGrid, {}, {}, {}};
  const std::vector<bool> above = BinsAboveSurface(kGrid);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    if (above[bin]) samples.bins.push_back(bin);
  }
  samples.rho.resize(samples.bins.size());
  const std::vector<Rgb> unclamped = UnclampedSamples(model, samples, 1);
  const std::vector<Rgb> rho = EvaluateSamples(model, samples, 1);
  double lowest = 0;
  for (int j = 0; j < samples.size(); ++j) {
    lowest = std::min(lowest, unclamped[j][0]);
    ASSERT_EQ(rho[j][0], std::max(unclamped[j][0], 0.0));
  }
  ASSERT_LT(lowest, -1e-3);
  const BrdfTable table = Reconstruct(model, "test", kGrid);
  EXPECT_EQ(ValidBins(table), above);
}

TEST(ReconstructTest, RejectsAModelThatOverflows) {
  FactorModel model(ModelSpec::SharedFactors(1, kGrid));
  for (double& x : model.parameters()) x = 1e300;
  EXPECT_THAT(ErrorOf([&] { Reconstruct(model, "huge.json", kGrid); }),
              IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}));
}

TEST(ReconstructTest, IsTheSameForAnyNumberOfThreads) {
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(3));
  EXPECT_EQ(Reconstruct(model, "test", {}, 1).stored, Reconstruct(model, "test", {}, 3).stored);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
