#include "io/formats/exports/klems_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/formats/optical/klems_basis.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"
#include "trilobe/model/measurement/albedo.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr size_t kPatches = 145;

ExportedBrdf True(bool anisotropic) {
  const PairBrdf brdf = TrueMaterial(anisotropic).brdf;
  const DirectionPair pair = {{0, 0, 1}, {0.6, 0, 0.8}};
  return {brdf, anisotropic, {{pair, brdf(pair)}}};
}

struct Patch {
  double least, most;  // bounds of sin^2 theta
  double begin, end;   // bounds of phi [rad]
  double projected() const { return (most - least) * (end - begin) / 2; }
  // The middles of n x n parts of the same projected solid angle.
  std::vector<Direction> Directions(int n, double turned) const {
    std::vector<Direction> directions;
    for (int row = 0; row < n; ++row) {
      const double s = std::sqrt(least + (most - least) * (row + 0.5) / n);
      for (int column = 0; column < n; ++column) {
        const double phi = begin + (end - begin) * (column + 0.5) / n + turned;
        directions.push_back({s * std::cos(phi), s * std::sin(phi), std::sqrt(1 - s * s)});
      }
    }
    return directions;
  }
};

std::vector<Patch> FullPatches() {
  std::vector<Patch> patches;
  for (const KlemsRing& ring : KlemsBases()[0].rings) {
    const auto square = [](double degrees) {
      return std::pow(std::sin(DegreesToRadians(degrees)), 2);
    };
    const double width = 2 * kPi / ring.patches;
    for (int k = 0; k < ring.patches; ++k) {
      patches.push_back(
          {square(ring.begin), square(ring.end), (k - 0.5) * width, (k + 0.5) * width});
    }
  }
  return patches;
}

Rgb MeanOf(const PairBrdf& brdf, const Patch& in, const Patch& out) {
  constexpr int kIn = 17, kOut = 30;  // without a common factor, lest highlights be hit in step
  Rgb sum{};
  for (const Direction& wi : in.Directions(kIn, kPi)) {
    for (const Direction& wo : out.Directions(kOut, 0)) {
      const Rgb value = brdf({wi, wo});
      for (int c = 0; c < kChannels; ++c) sum[c] += value[c] / (kIn * kIn * kOut * kOut);
    }
  }
  return sum;
}

TEST(KlemsBasis, PatchesFillTheHemisphere) {
  EXPECT_EQ(PatchesOf(KlemsBases()[0]).size(), kPatches);
  double sum = 0;
  for (const Patch& patch : FullPatches()) sum += patch.projected();
  EXPECT_NEAR(sum, kPi, 1e-12);
}

TEST(KlemsExport, ADiffuserIsTheSameEverywhere) {
  ExportedBrdf grey = True(false);
  grey.value = [](const DirectionPair& /*pair*/) { return Rgb{0.25, 0.25, 0.25}; };
  for (const Rgb& mean : KlemsMeans(grey, 1)) EXPECT_NEAR(mean[1], 0.25, 1e-12);
  const KlemsExport file = ExportKlems(grey, "a & b", 1);
  EXPECT_FALSE(file.colored);
  EXPECT_THAT(file.bytes, HasSubstr("<Name>a &amp; b</Name>"));
  EXPECT_THAT(file.bytes, Not(HasSubstr("CIE-X")));
}

class KlemsMeansTest : public testing::TestWithParam<bool> {
 protected:
  const ExportedBrdf brdf_ = True(GetParam());
  const std::vector<Rgb> means_ = KlemsMeans(brdf_, 2);  // takes a second
  const std::vector<Patch> patches_ = FullPatches();
};

TEST_P(KlemsMeansTest, AreThoseOfPairsOfPatchesAndKeepTheLight) {
  for (const size_t i : {0U, 5U, 30U, 70U, 100U, 140U}) {
    for (const size_t o : {0U, 5U, 30U, 31U, 70U, 82U, 100U, 112U, 140U}) {
      const Rgb expected = MeanOf(brdf_.value, patches_[i], patches_[o]);
      for (int c = 0; c < kChannels; ++c) {
        EXPECT_NEAR(means_[o * kPatches + i][c], expected[c], 0.04 * expected[c])
            << "from " << i << " to " << o;
      }
    }
  }
  for (size_t i = 0; i < kPatches; i += 7) {
    Rgb light{}, expected{};
    for (size_t o = 0; o < kPatches; ++o) {
      for (int c = 0; c < kChannels; ++c) {
        light[c] += means_[o * kPatches + i][c] * patches_[o].projected();
      }
    }
    const std::vector<Direction> directions = patches_[i].Directions(4, kPi);
    for (const Direction& wi : directions) {
      const PolarAngles at = ToPolarAngles(wi);
      const auto turned = [&](const DirectionPair& pair) {
        return brdf_.value(
            {TurnedAboutNormal(pair.wi, at.phi), TurnedAboutNormal(pair.wo, at.phi)});
      };
      const Rgb albedo = DirectionalAlbedo(turned, at.theta);
      for (int c = 0; c < kChannels; ++c) expected[c] += albedo[c] / 16;
    }
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(light[c], expected[c], 0.005 * expected[c]) << "from " << i;
    }
  }
}

TEST_P(KlemsMeansTest, AreReadBackAtTheMiddlesOfPatches) {
  const KlemsExport file = ExportKlems(brdf_, "x", 2);
  EXPECT_TRUE(file.colored);
  const Measurement measurement = ReadAs("radiance", file.bytes, "x.xml");
  ASSERT_EQ(measurement.samples.size(), kPatches * kPatches);
  for (size_t i = 0; i < kPatches; ++i) {
    for (size_t o = 0; o < kPatches; ++o) {
      const size_t j = i * kPatches + o;
      const Rgb& expected = means_[o * kPatches + i];
      for (int c = 0; c < kChannels; ++c) {
        ASSERT_NEAR(measurement.samples.rho[j][c], expected[c], 3e-5 * std::ranges::max(expected));
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, KlemsMeansTest, testing::Bool());

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
