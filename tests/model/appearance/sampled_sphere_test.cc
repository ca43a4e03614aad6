#include "trilobe/model/appearance/sampled_sphere.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "model/appearance/verdict.h"
#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

const AppearanceOptions kSmall = {.lights = 100, .size = 48};

// Blue, with a highlight and a dark channel.
Rgb Paint(const SphericalAngles& at) {
  const double cosine =
      Dot(ToDirections(at).wi,
          ToDirections(SphericalAngles{.theta_i = at.theta_o, .phi_i = at.phi_o + kPi}).wi);
  const double highlight = 0.6 * std::exp(-40 * (1 - cosine));
  return {0.002 + highlight, 0.03 + highlight, 0.12 + highlight};
}

// Samples of a goniometer, every 10 degrees up to 80.
BrdfSamples SamplesOf(const SphericalBrdf& brdf) {
  BrdfSamples samples;
  for (int i = 0; i <= 80; i += 10) {
    for (int o = 0; o <= 80; o += 10) {
      for (int phi = 5; phi < 360; phi += 20) {
        const SphericalAngles at = {DegreesToRadians(i), 0, DegreesToRadians(o),
                                    DegreesToRadians(phi)};
        samples.directions.push_back(at);
        samples.angles.push_back(ToHalfDiff(ToDirections(at)));
        samples.rho.push_back(brdf(at));
      }
    }
  }
  return samples;
}

std::vector<Rgb> ValuesAt(const SphericalBrdf& brdf, const BrdfSamples& samples) {
  std::vector<Rgb> values;
  for (const SphericalAngles& at : samples.directions) values.push_back(brdf(at));
  return values;
}

SeenError Compare(const BrdfSamples& samples, const SphericalBrdf& fitted, bool by_azimuth = false,
                  int threads = 1) {
  AppearanceOptions options = kSmall;
  options.num_threads = threads;
  return CompareSampledSphere(samples, ValuesAt(fitted, samples), fitted, by_azimuth, options);
}

Visibility VisibilityOf(const SeenError& seen) { return VerdictOf(seen).visibility; }

TEST(SampledSphere, TheSameMaterialCannotBeToldApart) {
  const SeenError seen = Compare(SamplesOf(Paint), Paint);
  EXPECT_LT(seen.mean_delta_e, 1e-9);
}

TEST(SampledSphere, NoiseIsNoFaultOfTheRightMaterial) {
  BrdfSamples noisy = SamplesOf(Paint);
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(1, 0.3);
  for (Rgb& rho : noisy.rho) {
    for (double& x : rho) x = std::max(x * noise(generator), 0.0);
  }
  const SeenError patches = CompareSamples(noisy, ValuesAt(Paint, noisy));
  ASSERT_EQ(VisibilityOf(patches), Visibility::kPlain);
  EXPECT_GT(patches.mean_delta_e, 10);
  const SeenError seen = Compare(noisy, Paint);
  EXPECT_LT(VisibilityOf(seen), Visibility::kPlain);
  EXPECT_LT(seen.mean_delta_e, 4);
}

// Readers set to 0 what is out of gamut, and instruments what they hardly see.
TEST(SampledSphere, WhatIsNextToBlackWeighsLittle) {
  BrdfSamples samples = SamplesOf(Paint);
  for (size_t j = 0; j < samples.rho.size(); j += 2) {
    const bool faint = samples.directions[j].theta_i > DegreesToRadians(75);
    if (faint && samples.rho[j][0] < 0.003) samples.rho[j] = {};
  }
  const SeenError patches = CompareSamples(samples, ValuesAt(Paint, samples));
  EXPECT_EQ(VisibilityOf(patches), Visibility::kPlain);
  const SeenError seen = Compare(samples, Paint);
  EXPECT_LT(VisibilityOf(seen), Visibility::kPlain);
  EXPECT_LT(seen.mean_delta_e, 0.5 * patches.mean_delta_e);
}

TEST(SampledSphere, AWrongMaterialIsPlain) {
  const BrdfSamples samples = SamplesOf(Paint);
  const auto turned = [](const SphericalAngles& at) -> Rgb {
    const Rgb rho = Paint(at);
    return {rho[2], rho[1], rho[0]};
  };
  const SeenError wrong_color = Compare(samples, turned);
  EXPECT_EQ(VisibilityOf(wrong_color), Visibility::kPlain);
  EXPECT_EQ(VerdictOf(wrong_color).fault, Fault::kWrongColor);
  const auto matte = [](const SphericalAngles&) -> Rgb { return {0.01, 0.04, 0.13}; };
  EXPECT_GE(VisibilityOf(Compare(samples, matte)), Visibility::kVisible);
  const auto dark = [](const SphericalAngles& at) -> Rgb {
    const Rgb rho = Paint(at);
    return {rho[0] / 2, rho[1] / 2, rho[2] / 2};
  };
  EXPECT_EQ(VerdictOf(Compare(samples, dark)).fault, Fault::kTooDark);
}

TEST(SampledSphere, DirectionsAreExchangedAndTurnedUnlessAzimuthsCount) {
  const auto brushed = [](const SphericalAngles& at) -> Rgb {
    const double across = 0.2 + 0.15 * std::cos(2 * at.phi_i);
    return {across, across, across};
  };
  BrdfSamples samples = SamplesOf(brushed);
  const BrdfSamples along = samples;
  for (SphericalAngles& at : samples.directions) {
    at.phi_i += kPi / 2;
    at.phi_o += kPi / 2;
  }
  for (size_t j = 0; j < samples.rho.size(); ++j) samples.rho[j] = brushed(samples.directions[j]);
  samples.directions.insert(samples.directions.end(), along.directions.begin(),
                            along.directions.end());
  samples.angles.insert(samples.angles.end(), along.angles.begin(), along.angles.end());
  samples.rho.insert(samples.rho.end(), along.rho.begin(), along.rho.end());
  const auto mean = [](const SphericalAngles&) -> Rgb { return {0.2, 0.2, 0.2}; };
  EXPECT_LT(Compare(samples, mean).mean_delta_e, 0.5);
  EXPECT_GT(Compare(samples, mean, /*by_azimuth=*/true).mean_delta_e, 5);
}

TEST(SampledSphere, OfAScanInAPlaneTheSamplesArePatches) {
  BrdfSamples scan;
  for (int o = -80; o <= 80; o += 2) {
    const SphericalAngles at = {DegreesToRadians(30), 0, DegreesToRadians(std::abs(o)),
                                o < 0 ? kPi : 0};
    scan.directions.push_back(at);
    scan.angles.push_back(ToHalfDiff(ToDirections(at)));
    scan.rho.push_back({0.1, 0.1, 0.1});
  }
  EXPECT_EQ(Compare(scan, Paint).mean_delta_e,
            CompareSamples(scan, ValuesAt(Paint, scan)).mean_delta_e);
}

TEST(SampledSphere, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto darker = [](const SphericalAngles& at) -> Rgb {
    Rgb rho = Paint(at);
    rho[1] *= 0.9;
    return rho;
  };
  const BrdfSamples samples = SamplesOf(Paint);
  EXPECT_EQ(Compare(samples, darker, false, 1).mean_delta_e,
            Compare(samples, darker, false, 3).mean_delta_e);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
