#include "trilobe/io/synth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "trilobe/base/error.h"
#include "trilobe/brdf/albedo.h"
#include "trilobe/brdf/measurement_stats.h"

namespace trilobe {
namespace {

constexpr MerlGrid kSmallGrid = {.theta_h = 20, .theta_d = 18, .phi_d = 24};

class SynthMaterialTest : public testing::TestWithParam<SynthMaterial> {};

TEST_P(SynthMaterialTest, IsReciprocalPositiveAndFinite) {
  for (int bin = 0; bin < kSmallGrid.size(); ++bin) {
    const DirectionPair pair = ToDirections(kSmallGrid.Center(bin));
    if (!(pair.wi[2] > 0 && pair.wo[2] > 0)) continue;
    const Rgb a = GetParam().brdf(pair), b = GetParam().brdf({pair.wo, pair.wi});
    for (int c = 0; c < kChannels; ++c) {
      ASSERT_TRUE(std::isfinite(a[c]));
      ASSERT_GT(a[c], 0);
      ASSERT_NEAR(a[c], b[c], 1e-12 * a[c]);
    }
  }
}

TEST_P(SynthMaterialTest, ReflectsNoMoreLightThanItGets) {
  std::vector<double> theta_i;
  for (double degrees = 0; degrees < 90; degrees += 2.5) {
    theta_i.push_back(DegreesToRadians(degrees));
  }
  const std::vector<Rgb> albedo = DirectionalAlbedos(GetParam().brdf, theta_i, 2);
  for (const Rgb& a : albedo) {
    for (const double x : a) {
      EXPECT_LE(x, 1);
      EXPECT_GT(x, 0.01);
    }
  }
}

std::string TestName(const testing::TestParamInfo<SynthMaterial>& material) {
  std::string name = material.param.name;
  std::erase(name, '-');
  return name;
}
INSTANTIATE_TEST_SUITE_P(All, SynthMaterialTest, testing::ValuesIn(SynthMaterials()), TestName);

TEST(SynthesizeTest, WithoutNoiseIsTheBrdfAtEveryBinAboveTheSurface) {
  const SynthMaterial& material = FindSynthMaterial("plastic");
  const BrdfTable table = Synthesize(material, 0, 1, kSmallGrid);
  EXPECT_EQ(table.source, "synth:plastic");
  const BinCounts bins = CountBins(table);
  EXPECT_EQ(bins.valid + bins.below_surface, bins.total);
  const int bin = kSmallGrid.Index(3, 5, 7);
  const Rgb rho = material.brdf(ToDirections(kSmallGrid.Center(bin)));
  for (int c = 0; c < kChannels; ++c) {
    EXPECT_NEAR(table.Value(c, bin), rho[c], 1e-14 * rho[c]);
  }
}

TEST(SynthesizeTest, IsTheSameForAnyNumberOfThreadsAndDiffersBySeed) {
  const SynthMaterial& material = FindSynthMaterial("copper");
  const BrdfTable one = Synthesize(material, 0.1, 5, kSmallGrid, 1);
  EXPECT_EQ(Synthesize(material, 0.1, 5, kSmallGrid, 3).stored, one.stored);
  EXPECT_NE(Synthesize(material, 0.1, 6, kSmallGrid, 1).stored, one.stored);
}

// Over n values the mean of the factor has a standard error of noise / sqrt(n), and its standard
// deviation one of about 1 / sqrt(2 n) of itself.
TEST(SynthesizeTest, NoiseHasMeanOneAndTheAskedDeviation) {
  const MerlGrid grid = {.theta_h = 40, .theta_d = 40, .phi_d = 60};
  const SynthMaterial& material = FindSynthMaterial("foam");
  const BrdfTable clean = Synthesize(material, 0, 1, grid);
  const BrdfTable noisy = Synthesize(material, 0.2, 1, grid);
  const std::vector<bool> valid = ValidBins(noisy);
  double n = 0, sum = 0, squares = 0, product = 0;
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (!valid[bin]) continue;
    const double red = noisy.stored[0][bin] / clean.stored[0][bin] - 1;
    const double blue = noisy.stored[2][bin] / clean.stored[2][bin] - 1;
    n += 1;
    sum += red;
    squares += red * red;
    product += red * blue;
  }
  EXPECT_NEAR(sum / n, 0, 5 * 0.2 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.2, 5 * 0.2 / std::sqrt(n));
  EXPECT_NEAR(product / n / 0.04, 0, 5 / std::sqrt(n));  // channels are independent
}

TEST(SynthesizeTest, NoiseLosesSomeGrazingBinsOnly) {
  const MerlGrid grid = {.theta_h = 40, .theta_d = 40, .phi_d = 60};
  const BrdfTable table = Synthesize(FindSynthMaterial("foam"), 0.01, 1, grid);
  const std::vector<bool> above = BinsAboveSurface(grid), valid = ValidBins(table);
  int lost = 0, all = 0;
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (!above[bin]) continue;
    ++all;
    if (valid[bin]) continue;
    ++lost;
    const Cosines cosines = ToCosines(grid.Center(bin));
    EXPECT_LT(std::min(cosines.i, cosines.o), std::cos(DegreesToRadians(80)));
  }
  EXPECT_GT(lost, all / 1000);
  EXPECT_LT(lost, all / 10);
}

TEST(SynthesizeTest, RejectsBadNoise) {
  const SynthMaterial& material = SynthMaterials()[0];
  for (const double noise : {-0.1, 1.1, std::nan("")}) {
    EXPECT_THROW(Synthesize(material, noise, 1, kSmallGrid), Error);
  }
}

TEST(FindSynthMaterialTest, ListsTheKnownNames) {
  try {
    FindSynthMaterial("unobtainium");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'unobtainium'; known: plastic, car-paint"));
  }
}

}  // namespace
}  // namespace trilobe
