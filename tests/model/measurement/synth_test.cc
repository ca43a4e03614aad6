#include "trilobe/model/measurement/synth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/error_of.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe::TRILOBE_TEST_FILE {
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

Direction At(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

class AnisotropicMaterialTest : public testing::TestWithParam<SynthMaterial> {};

TEST_P(AnisotropicMaterialTest, IsReciprocalAndFinite) {
  const HemisphereGrid grid{9, 20};
  bool changes = false;
  for (int i = 0; i < grid.nodes(); ++i) {
    for (int o = 0; o < grid.nodes(); ++o) {
      const SphericalAngles at = grid.Angles(i, o);
      const DirectionPair pair = ToDirections(at);
      const Rgb a = GetParam().brdf(pair), b = GetParam().brdf({pair.wo, pair.wi});
      const Rgb turned = GetParam().brdf(
          ToDirections(SphericalAngles{at.theta_i, at.phi_i + 0.3, at.theta_o, at.phi_o + 0.3}));
      for (int c = 0; c < kChannels; ++c) {
        ASSERT_TRUE(std::isfinite(a[c]) && a[c] >= 0);
        ASSERT_NEAR(a[c], b[c], 1e-12 * a[c]);
        changes |= std::abs(turned[c] - a[c]) > 0.01 * a[c];
      }
    }
  }
  EXPECT_TRUE(changes);
}

// Integrates by the midpoint rule over wo in steps of 1 and 2 degrees.
TEST_P(AnisotropicMaterialTest, ReflectsNoMoreLightThanItGets) {
  constexpr int kThetas = 90, kPhis = 180;
  for (const double theta_i : {0.0, 60.0, 88.0}) {
    for (const double phi_i : {0.0, 50.0, 180.0}) {
      const Direction wi = At(DegreesToRadians(theta_i), DegreesToRadians(phi_i));
      Rgb albedo{};
      for (int a = 0; a < kThetas; ++a) {
        const double theta = (a + 0.5) * kPi / 2 / kThetas;
        for (int b = 0; b < kPhis; ++b) {
          const Rgb rho = GetParam().brdf({wi, At(theta, (b + 0.5) * 2 * kPi / kPhis)});
          for (int c = 0; c < kChannels; ++c) {
            albedo[c] += rho[c] * std::sin(theta) * std::cos(theta);
          }
        }
      }
      for (const double x : albedo) {
        EXPECT_LE(x * (kPi / 2 / kThetas) * (2 * kPi / kPhis), 1) << theta_i << " " << phi_i;
      }
    }
  }
}

TEST_P(AnisotropicMaterialTest, HasTheSymmetriesOfItsGrain) {
  // The pile of velvet leans towards x; all others look the same from both ends of the grain.
  const bool leans = GetParam().name == "velvet";
  const DirectionPair pair = {At(0.5, 0.4), At(1.1, 2.6)};
  const Rgb rho = GetParam().brdf(pair);
  const auto with_signs = [&](double x, double y) {
    return GetParam().brdf({{x * pair.wi[0], y * pair.wi[1], pair.wi[2]},
                            {x * pair.wo[0], y * pair.wo[1], pair.wo[2]}});
  };
  for (int c = 0; c < kChannels; ++c) {
    EXPECT_NEAR(with_signs(1, -1)[c], rho[c], 1e-12);
    for (const double other : {with_signs(-1, 1)[c], with_signs(-1, -1)[c]}) {
      if (leans && c == 0) {  // red, which is all that the pile scatters
        EXPECT_GT(std::abs(other - rho[c]), 0.05 * rho[c]);
      } else if (!leans) {
        EXPECT_NEAR(other, rho[c], 1e-12);
      }
    }
  }
}

std::string TestName(const testing::TestParamInfo<SynthMaterial>& material) {
  std::string name = material.param.name;
  std::erase(name, '-');
  return name;
}
std::vector<SynthMaterial> Materials(bool anisotropic) {
  std::vector<SynthMaterial> materials;
  for (const SynthMaterial& material : SynthMaterials()) {
    if (material.anisotropic == anisotropic) materials.push_back(material);
  }
  return materials;
}
INSTANTIATE_TEST_SUITE_P(All, SynthMaterialTest, testing::ValuesIn(Materials(false)), TestName);
INSTANTIATE_TEST_SUITE_P(All, AnisotropicMaterialTest, testing::ValuesIn(Materials(true)),
                         TestName);

// The lobe of Ward's Table 1 for rolled brass, in luminance, at the mirror direction.
TEST(AnisotropicMaterials, WardsBrassHasHisPeak) {
  const double theta = 0.5;
  const Rgb rho = FindSynthMaterial("rolled_brass").brdf({At(theta, 0), At(theta, kPi)});
  const double peak = 0.10 / kPi + 0.33 / (4 * kPi * 0.050 * 0.16 * std::cos(theta));
  EXPECT_NEAR(0.2126 * rho[0] + 0.7152 * rho[1] + 0.0722 * rho[2], peak, 1e-3 * peak);
}

// With equal roughness along x and y it would be the isotropic one: compare along the diagonal,
// where the half vector's slopes of one unit weigh as those of the mean of 1 / alpha^2.
TEST(AnisotropicMaterials, GgxIsNarrowAlongTheGrain) {
  const auto brdf = FindSynthMaterial("aniso_ggx_steel").brdf;
  const auto tilted = [&](double phi) { return brdf({At(0.3, phi), At(0.3, phi)})[0]; };
  EXPECT_GT(brdf({At(0, 0), At(0, 0)})[0], tilted(kPi / 2));
  EXPECT_GT(tilted(kPi / 2), 10 * tilted(0));
}

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

TEST(SynthesizeSamplesTest, TakesUtiasDirectionsOrAnyGrid) {
  const Measurement linen = LoadMeasurement("synth:linen");
  EXPECT_EQ(linen.source, "synth:linen");
  EXPECT_EQ(linen.kind, "synthetic measurement, scattered");
  EXPECT_TRUE(linen.anisotropic);
  EXPECT_EQ(linen.counts.valid, 288 * 288);
  const int i = 48 * 3 + 7, o = 48 * 5 + 30;
  const SphericalAngles& at = linen.samples.directions[288 * i + o];
  EXPECT_NEAR(RadiansToDegrees(at.theta_i), 45, 1e-12);
  EXPECT_NEAR(RadiansToDegrees(at.phi_o), 225, 1e-12);
  EXPECT_EQ(linen.samples.rho[288 * i + o], FindSynthMaterial("linen").brdf(ToDirections(at)));

  const Measurement finer = LoadMeasurement("synth:linen@9x12");
  EXPECT_EQ(finer.source, "synth:linen@9x12");
  EXPECT_EQ(SamplesOf(finer).source, "synth:linen@9x12");
  EXPECT_EQ(finer.counts.valid, 108 * 108);
  EXPECT_NEAR(MaxAngleDegrees(finer), 80, 1e-12);
  // Isotropic ones, too, where a grid is asked for.
  EXPECT_TRUE(LoadMeasurement("synth:foam").table);
  EXPECT_EQ(LoadMeasurement("synth:foam@2x3").counts.valid, 36);
  EXPECT_THAT(ErrorOf([] { LoadMeasurement("synth:foam@"); }),
              IsError(ErrorKind::kFormat, {.key = "grid of directions"}));
}

TEST(SynthesizeTest, TakesAnyGridOfBins) {
  const MerlGrid grid{.theta_h = 8, .theta_d = 12, .phi_d = 15};
  const BrdfTable table = LoadTable("synth:foam@8x12x15");
  EXPECT_EQ(table.grid, grid);
  EXPECT_EQ(table.source, "synth:foam@8x12x15");
  const BrdfTable expected = Synthesize(FindSynthMaterial("foam"), 0, 1, grid);
  EXPECT_EQ(table.stored, expected.stored);
  for (const char* const bad : {"3x30x60", "30x361x60", "30x30x", "axbxc", "x30x60", "360x360x360",
                                "-30x30x60", "30x30x60.5"}) {
    EXPECT_THAT(ErrorOf([&] { LoadTable("synth:foam@" + std::string(bad)); }),
                IsError(ErrorKind::kFormat, {.key = "grid of bins", .value = bad}));
  }
  EXPECT_THAT(
      ErrorOf([] { SynthSourceOf("synth:velvet@30x30x60"); }),
      IsError(ErrorKind::kUnsupported, {.file = "synth:velvet@30x30x60", .key = "anisotropic"}));
  EXPECT_THAT(ErrorOf([] { LoadTable("synth:linen"); }),
              IsError(ErrorKind::kUnsupported, {.key = "table"}));
  EXPECT_THAT(ErrorOf([] { Synthesize(FindSynthMaterial("linen"), 0, 1); }),
              IsError(ErrorKind::kUnsupported, {.file = "synth:linen", .key = "anisotropic"}));
}

TEST(SynthesizeSamplesTest, NoiseAndLossDependOnTheSeedAlone) {
  const SynthMaterial& silk = FindSynthMaterial("shot_silk");
  const HemisphereGrid grid{18, 6};  // up to 85 degrees, where some are lost
  const Measurement one = SynthesizeSamples(silk, 0.1, 5, grid, 1);
  EXPECT_EQ(SynthesizeSamples(silk, 0.1, 5, grid, 3).samples.rho, one.samples.rho);
  EXPECT_NE(SynthesizeSamples(silk, 0.1, 6, grid, 1).samples.rho, one.samples.rho);
  EXPECT_GT(one.counts.missing, 0);
  EXPECT_EQ(one.counts.missing + one.counts.valid, one.counts.total);
  EXPECT_EQ(SynthesizeSamples(silk, 0, 5, grid).counts.missing, 0);
  double sum = 0, squares = 0;
  for (int j = 0; j < one.samples.size(); ++j) {
    const double clean = silk.brdf(ToDirections(one.samples.directions[j]))[1];
    sum += one.samples.rho[j][1] / clean - 1;
    squares += std::pow(one.samples.rho[j][1] / clean - 1, 2);
  }
  const double n = one.samples.size();
  EXPECT_NEAR(sum / n, 0, 5 * 0.1 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.1, 5 * 0.1 / std::sqrt(n));
}

TEST(LeaveOutAtRandomTest, LeavesOutAShareBySeed) {
  const Measurement all = LoadMeasurement("synth:velvet@4x24", {.noise = 0.1});
  const Measurement part = LoadMeasurement("synth:velvet@4x24", {.noise = 0.1, .missing = 0.3});
  const double n = all.counts.valid;
  EXPECT_NEAR(part.counts.missing / n, 0.3, 5 * std::sqrt(0.3 * 0.7 / n));
  EXPECT_EQ(part.counts.missing + part.counts.valid, all.counts.total);
  EXPECT_EQ(part.samples.size(), part.counts.valid);
  // The remaining samples are unchanged.
  for (int j = 0, k = 0; j < part.samples.size(); ++j, ++k) {
    while (k < all.samples.size() && all.samples.rho[k] != part.samples.rho[j]) ++k;
    ASSERT_LT(k, all.samples.size());
  }
  const auto other_seed = LoadMeasurement("synth:velvet@4x24", {.missing = 0.3, .seed = 2});
  const auto this_seed = LoadMeasurement("synth:velvet@4x24", {.missing = 0.3});
  EXPECT_NE(other_seed.samples.rho, this_seed.samples.rho);
  // Bins of a table are lost.
  const BinCounts bins = CountsOf(LoadMeasurement("synth:foam", {.missing = 0.5}));
  EXPECT_NEAR(bins.negative, 1096216 / 2.0, 5 * std::sqrt(1096216 / 4.0));
  EXPECT_EQ(bins.negative + bins.valid, 1096216);
  for (const double share : {-0.1, 1.0, std::nan("")}) {
    EXPECT_THAT(ErrorOf([&] { LoadMeasurement("synth:velvet", {.missing = share}); }),
                IsError(ErrorKind::kRange, {.key = "missing"}));
  }
}

TEST(SynthesizeTest, RejectsBadNoise) {
  const SynthMaterial& material = SynthMaterials()[0];
  for (const double noise : {-0.1, 1.1, std::nan("")}) {
    EXPECT_THAT(ErrorOf([&] { Synthesize(material, noise, 1, kSmallGrid); }),
                IsError(ErrorKind::kRange, {.key = "noise"}));
  }
}

TEST(FindSynthMaterialTest, ListsTheKnownNames) {
  EXPECT_THAT(ErrorOf([] { FindSynthMaterial("unobtainium"); }),
              IsError(ErrorKind::kUnknown, {.key = "synthetic material", .value = "unobtainium"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
