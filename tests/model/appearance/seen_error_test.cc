#include "trilobe/model/appearance/seen_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "model/appearance/color.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/appearance/appearance.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

Rgb Grey(double light) { return {light, light, light}; }

TEST(SeenError, TellsWhereAndHowPixelsDiffer) {
  SeenErrorSum sum;
  sum.Add(Grey(0.8), Grey(0.4), /*grazing=*/false);  // a highlight, too dark
  sum.Add(Grey(0.3), Grey(0.3), /*grazing=*/false);
  sum.Add(Grey(0.9), {0.9, 0.5, 0.5}, /*grazing=*/true);  // however bright
  sum.Add(Grey(0.2), Grey(0.2), /*grazing=*/true);
  const SeenError error = sum.Total();
  const double dark = ToLab(Grey(0.4))[0] - ToLab(Grey(0.8))[0];
  const double red = LabDifference(ToLab(Grey(0.9)), ToLab({0.9, 0.5, 0.5}));
  EXPECT_NEAR(error.mean_delta_e, (-dark + red) / 4, 1e-12);
  const PlaceError& highlights = error.at(SeenPlace::kHighlights);
  EXPECT_EQ(highlights.share, 0.25);
  EXPECT_NEAR(highlights.squares, dark * dark / (dark * dark + red * red), 1e-12);
  EXPECT_NEAR(highlights.mean_delta_e, -dark, 1e-12);
  EXPECT_NEAR(highlights.lightness, dark, 1e-12);
  EXPECT_NEAR(highlights.color, 0, 1e-12);
  const PlaceError& grazing = error.at(SeenPlace::kGrazing);
  EXPECT_EQ(grazing.share, 0.5);
  EXPECT_NEAR(grazing.mean_delta_e, red / 2, 1e-12);
  EXPECT_GT(grazing.color, 0.5);
  EXPECT_EQ(error.at(SeenPlace::kRest).mean_delta_e, 0);
}

// Half the light of an orange lamp is the same colour, though the eye sees other a and b.
TEST(SeenError, LessLightIsNoOtherColour) {
  SeenErrorSum less;
  less.Add({0.6, 0.3, 0.05}, {0.3, 0.15, 0.025}, false);
  EXPECT_NEAR(less.Total().at(SeenPlace::kRest).color, 0, 1e-12);
  // A colour that the picture clips, and that turns yellow there, is no colour error either.
  SeenErrorSum clipped;
  clipped.Add({4, 2, 0.2}, {0.8, 0.4, 0.04}, false);
  EXPECT_NEAR(clipped.Total().at(SeenPlace::kHighlights).color, 0, 1e-12);
  SeenErrorSum other;
  other.Add({0.6, 0.3, 0.05}, {0.3, 0.3, 0.3}, false);
  EXPECT_GT(other.Total().at(SeenPlace::kRest).color, 0.8);
}

TEST(SeenError, OfEqualPicturesOrNoneIsNothing) {
  SeenErrorSum same;
  same.Add(Grey(0.5), Grey(0.5), false);
  for (const SeenError& error : {same.Total(), SeenErrorSum().Total()}) {
    EXPECT_EQ(error.psnr_db, std::numeric_limits<double>::infinity());
    EXPECT_EQ(error.mean_delta_e, 0);
    EXPECT_EQ(error.delta_e_95, 0);
    for (const PlaceError& place : error.places) EXPECT_EQ(place.mean_delta_e, 0);
  }
}

// The outer quarter of the disc is the rim.
TEST(SeenError, OfASphereKnowsItsRim) {
  constexpr int kSize = 64;
  RenderedImage measured{kSize, std::vector<Rgb>(kSize * kSize), {}};
  measured.coverage.assign(kSize * kSize, -1);
  RenderedImage fitted = measured;
  for (int k = 0; k < kSize * kSize; ++k) {
    const double radius = std::hypot((k % kSize + 0.5) / kSize * 2 - 1,
                                     (k / kSize + 0.5) / kSize * 2 - 1);  // NOLINT
    if (radius >= 1) continue;
    measured.coverage[k] = fitted.coverage[k] = 1;
    measured.radiance[k] = Grey(1);
    fitted.radiance[k] = Grey(radius > std::sqrt(0.75) ? 2 : 1);
  }
  const SphereError error = CompareSpheres(measured, fitted);
  EXPECT_NEAR(error.at(SeenPlace::kGrazing).share, 0.25, 0.01);
  EXPECT_EQ(error.at(SeenPlace::kGrazing).squares, 1);
  EXPECT_GT(error.at(SeenPlace::kGrazing).lightness, 0);
  EXPECT_EQ(error.at(SeenPlace::kRest).mean_delta_e, 0);
}

// --- Samples ------------------------------------------------------------------------------------

// Light and eye beside each other at theta.
BrdfSamples Scattered(const std::vector<double>& thetas_deg, const std::vector<Rgb>& rho) {
  BrdfSamples samples;
  samples.source = "samples";
  samples.rho = rho;
  for (const double theta : thetas_deg) {
    samples.angles.push_back({DegreesToRadians(theta), 0, 0});
  }
  return samples;
}

// With 0.35 / cos theta_h each, the exposure is 1, whatever the unit of the values.
TEST(CompareSamples, SeesEachAsAPatchUnderItsOwnLight) {
  for (const double unit : {1.0, 1e-6, 1e6}) {
    const BrdfSamples samples = Scattered(
        {0, 0, 70},
        {Grey(0.35 * unit), Grey(0.35 * unit), Grey(0.35 * unit / std::cos(DegreesToRadians(70)))});
    std::vector<Rgb> fitted = samples.rho;
    for (double& x : fitted[0]) x /= 2;
    const SeenError error = CompareSamples(samples, fitted);
    EXPECT_NEAR(error.mean_delta_e, LabDifference(ToLab(Grey(0.35)), ToLab(Grey(0.175))) / 3, 1e-9);
    EXPECT_NEAR(error.at(SeenPlace::kGrazing).share, 1.0 / 3, 1e-12);
    EXPECT_EQ(error.at(SeenPlace::kGrazing).mean_delta_e, 0);
  }
}

// A highlight a million times as bright as the rest leaves the rest to be seen.
TEST(CompareSamples, ClipsBeforeItExposes) {
  std::vector<Rgb> rho(10, Grey(1));
  rho[0] = Grey(1e6);
  std::vector<Rgb> fitted = rho;
  fitted[1] = Grey(0.5);
  const SeenError error = CompareSamples(Scattered(std::vector<double>(10, 0), rho), fitted);
  // Nine of 10 have to be 0.25 / 0.9 for a mean of 0.35.
  const double light = 0.25 / 0.9;
  EXPECT_NEAR(error.mean_delta_e, LabDifference(ToLab(Grey(light)), ToLab(Grey(light / 2))) / 10,
              1e-9);
}

TEST(CompareSamples, OfBlackOnesHasNoDifferenceToBlack) {
  const BrdfSamples black = Scattered({0, 10}, {Rgb{}, Rgb{}});
  EXPECT_EQ(CompareSamples(black, black.rho).mean_delta_e, 0);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
