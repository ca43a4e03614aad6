#include "trilobe/model/appearance/appearance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "model/appearance/color.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid = {.theta_h = 30, .theta_d = 30, .phi_d = 60};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

AppearanceOptions Quick(int num_threads = 1) {
  return {.lights = 80, .size = 24, .num_threads = num_threads};
}

BrdfTable Plastic() { return Synthesize(FindSynthMaterial("plastic"), 0, 1, kGrid); }

BrdfTable Constant(double rho) {
  BrdfTable table = MakeInvalidTable("constant", kGrid);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    for (int c = 0; c < kChannels; ++c) table.SetValue(c, bin, rho);
  }
  return table;
}

AngularBrdf Grey(double rho) {
  return [rho](const HalfDiffAngles& /*angles*/, const Cosines& /*cosines*/) {
    return Rgb{rho, rho, rho};
  };
}

// Marks bins as values that nobody measured.
void Unmeasure(const std::function<bool(const HalfDiffAngles&)>& where, BrdfTable* table) {
  table->unmeasured.assign(table->grid.size(), Unmeasured::kNo);
  for (int bin = 0; bin < table->grid.size(); ++bin) {
    if (where(table->grid.Center(bin))) table->unmeasured[bin] = Unmeasured::kExtrapolated;
  }
}

std::vector<double> Numbers(const AppearanceReport& report) {
  std::vector<double> numbers = {report.sphere.psnr_db,
                                 report.sphere.mean_delta_e,
                                 report.sphere.delta_e_95,
                                 report.sphere.mean_color_error,
                                 report.sphere.exposure,
                                 report.albedo.mean,
                                 report.albedo.max,
                                 report.at_centers.log,
                                 report.at_centers.relative,
                                 report.between_centers.log,
                                 report.between_centers.relative};
  for (const auto* const albedos : {&report.albedo.measured, &report.albedo.fitted}) {
    for (const Rgb& albedo : *albedos) numbers.insert(numbers.end(), albedo.begin(), albedo.end());
  }
  if (report.beyond) {
    numbers.insert(numbers.end(), {report.beyond->share, report.beyond->largest,
                                   report.beyond->largest_within, report.beyond->psnr_db});
  }
  return numbers;
}

void ExpectNoDifference(const AppearanceReport& report, double tolerance) {
  EXPECT_GE(report.sphere.psnr_db, tolerance > 0 ? 200 : kInfinity);
  for (const double x :
       {report.sphere.mean_delta_e, report.sphere.delta_e_95, report.sphere.mean_color_error,
        report.albedo.mean, report.albedo.max, report.at_centers.log, report.at_centers.relative,
        report.between_centers.log, report.between_centers.relative}) {
    EXPECT_NEAR(x, 0, tolerance);
  }
}

std::optional<Error> ErrorFrom(const BrdfTable& table, const AngularBrdf& fitted,
                               const AppearanceOptions& options = Quick()) {
  return ErrorOf([&] { CompareAppearance(table, fitted, options); });
}

// --- Spheres ------------------------------------------------------------------------------------

double Square(double x) { return x * x; }

// Grey of 0.5 and 0.2 has a mean of 0.35: an exposure of 1.
TEST(CompareSpheres, MatchesNumbersWorkedOutByHand) {
  RenderedImage measured{2, std::vector<Rgb>(4), {-1, 0, 1, 0.25}};
  measured.radiance[1] = {8, 8, 8};  // no light on it counts
  measured.radiance[2] = {0.5, 0.5, 0.5};
  measured.radiance[3] = {0.2, 0.2, 0.2};
  RenderedImage fitted = measured;
  fitted.radiance[2] = {0.25, 0.5, 0.5};
  const SphereError error = CompareSpheres(measured, fitted);
  EXPECT_NEAR(error.exposure, 1, 1e-14);
  // The sRGB curve: 1.055 * 0.5^(1/2.4) - 0.055 = 0.735357, of 0.25 0.537099.
  const double difference = 1.055 * (std::pow(0.5, 1 / 2.4) - std::pow(0.25, 1 / 2.4));
  EXPECT_NEAR(difference, 0.198258, 1e-6);
  EXPECT_NEAR(error.psnr_db, -10 * std::log10(Square(difference) / 6), 1e-9);
  EXPECT_NEAR(error.mean_color_error, 0.25 / (0.7 * std::sqrt(3)), 1e-14);
  const double delta_e = LabDifference(ToLab({0.5, 0.5, 0.5}), ToLab({0.25, 0.5, 0.5}));
  EXPECT_NEAR(error.mean_delta_e, delta_e / 2, 1e-11);
  EXPECT_EQ(error.delta_e_95, 0);
}

// Twice the light on both is the same picture; and what is brighter than white is white.
TEST(CompareSpheres, ExposesByTheMeasuredAndClips) {
  RenderedImage measured{1, {{0.7, 0.7, 0.7}}, {1}};
  RenderedImage fitted{1, {{1.4, 1.4, 1.4}}, {1}};
  const SphereError error = CompareSpheres(measured, fitted);
  EXPECT_NEAR(error.exposure, 0.5, 1e-14);
  EXPECT_NEAR(error.psnr_db, -20 * std::log10(EncodeSrgb(0.7) - EncodeSrgb(0.35)), 1e-9);
  EXPECT_NEAR(error.mean_color_error, 1, 1e-14);
  fitted.radiance[0] = {7, 7, 7};
  EXPECT_NEAR(CompareSpheres(measured, fitted).psnr_db, -20 * std::log10(1 - EncodeSrgb(0.35)),
              1e-9);
}

TEST(CompareSpheres, NinetyFivePercentOfThePixelsStayBelow) {
  RenderedImage measured{10, std::vector<Rgb>(100, {0.35, 0.35, 0.35}),
                         std::vector<double>(100, 1)};
  RenderedImage fitted = measured;
  double largest = 0;
  for (int k = 0; k < 100; ++k) {
    fitted.radiance[(k * 37) % 100] = {0.35 + 0.001 * k, 0.35, 0.35};
    if (k == 94) {
      largest = LabDifference(ToLab({0.35 + 0.001 * k, 0.35, 0.35}), ToLab({0.35, 0.35, 0.35}));
    }
  }
  EXPECT_NEAR(CompareSpheres(measured, fitted).delta_e_95, largest, 1e-9);
}

TEST(CompareSpheres, BlackHasNoExposureButIsSeen) {
  const RenderedImage black{2, std::vector<Rgb>(4), {1, 1, 1, 1}};
  const SphereError same = CompareSpheres(black, black);
  EXPECT_EQ(same.exposure, 0);
  EXPECT_EQ(same.psnr_db, kInfinity);
  EXPECT_EQ(same.mean_delta_e, 0);
  RenderedImage grey = black;
  grey.radiance[1] = {1e-3, 1e-3, 1e-3};
  const SphereError seen = CompareSpheres(black, grey);
  EXPECT_EQ(seen.exposure, 0);
  EXPECT_EQ(seen.mean_color_error, 0);
  EXPECT_NEAR(seen.psnr_db, -10 * std::log10(0.25), 1e-9);
  EXPECT_NEAR(seen.mean_delta_e, 25, 1e-9);
}

// --- Materials ----------------------------------------------------------------------------------

TEST(CompareAppearance, NothingDiffersFromItself) {
  const BrdfTable table = Plastic();
  const TabulatedBrdf brdf(table);
  const AppearanceReport report = CompareAppearance(table, Interpolated(brdf), Quick());
  ExpectNoDifference(report, 0);
  EXPECT_FALSE(report.beyond);
  EXPECT_EQ(report.environment, "studio");
  EXPECT_EQ(report.lights, 80);
  EXPECT_EQ(report.size, 24);
  EXPECT_GT(report.sphere.exposure, 0);
  ASSERT_EQ(report.albedo.theta_i.size(), report.albedo.measured.size());
  EXPECT_GT(report.albedo.measured[0][0], 0.01);
}

TEST(CompareAppearance, ATenthMoreIsATenthOff) {
  const BrdfTable table = Plastic();
  const TabulatedBrdf brdf(table);
  const AngularBrdf more = [&](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
    Rgb rho = brdf.Interpolate(angles);
    for (double& x : rho) x *= 1.1;
    return rho;
  };
  const AppearanceReport report = CompareAppearance(table, more, Quick());
  EXPECT_NEAR(report.sphere.mean_color_error, 0.1, 1e-12);
  EXPECT_GT(report.sphere.psnr_db, 25);
  EXPECT_LT(report.sphere.psnr_db, 45);
  EXPECT_GT(report.sphere.mean_delta_e, 1);
  EXPECT_LT(report.sphere.mean_delta_e, report.sphere.delta_e_95);
  double mean = 0, max = 0;
  for (const Rgb& albedo : report.albedo.measured) {
    for (const double x : albedo) {
      mean += 0.1 * x / static_cast<double>(kChannels * report.albedo.measured.size());
      max = std::max(max, 0.1 * x);
    }
  }
  EXPECT_NEAR(report.albedo.mean, mean, 1e-12);
  EXPECT_NEAR(report.albedo.max, max, 1e-12);
  for (const PointErrors& errors : {report.at_centers, report.between_centers}) {
    EXPECT_NEAR(errors.relative, 0.1, 0.005);  // but for the floor
    EXPECT_GT(errors.log, 0.001);
    EXPECT_LT(errors.log, std::log(1.1));
  }
}

// Lambertian materials have known albedos: 1/pi sr^-1 reflects all light.
TEST(CompareAppearance, KnowsTheAlbedoOfALambertianMaterial) {
  const AppearanceReport report = CompareAppearance(Constant(0.5 / kPi), Grey(0.25 / kPi), Quick());
  for (size_t k = 0; k < report.albedo.theta_i.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(report.albedo.measured[k][c], 0.5, 1e-3) << k;
      EXPECT_NEAR(report.albedo.fitted[k][c], 0.25, 5e-4) << k;
    }
  }
  EXPECT_NEAR(report.albedo.mean, 0.25, 1e-3);
  EXPECT_NEAR(report.sphere.mean_color_error, 0.5, 1e-12);
  EXPECT_NEAR(report.at_centers.relative, 0.25 / kPi / (0.5 / kPi + 1e-3), 1e-12);
  EXPECT_NEAR(report.between_centers.relative, 0.25 / kPi / (0.5 / kPi + 1e-3), 1e-12);
}

// A ripple that vanishes at bin centres shows between them only.
TEST(CompareAppearance, LooksBetweenTheCentres) {
  const BrdfTable table = Plastic();
  const TabulatedBrdf brdf(table);
  const AngularBrdf rippled = [&](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
    const double ripple = std::cos(kPi * kGrid.ThetaHCoordinate(angles.theta_h));
    Rgb rho = brdf.Interpolate(angles);
    for (double& x : rho) x *= 1 + 0.5 * ripple * ripple;
    return rho;
  };
  const AppearanceReport report = CompareAppearance(table, rippled, Quick());
  EXPECT_LT(report.at_centers.log, 1e-9);
  EXPECT_LT(report.at_centers.relative, 1e-9);
  EXPECT_NEAR(report.between_centers.relative, 0.5, 0.02);
  EXPECT_GT(report.between_centers.log, 0.01);
  EXPECT_NEAR(report.sphere.mean_color_error, 0.25, 0.05);
  EXPECT_LT(report.sphere.psnr_db, 40);
}

// Renderers clamp negative values, too: no light is taken away.
TEST(CompareAppearance, ANegativeValueIsBlack) {
  const BrdfTable table = Constant(0.1);
  EXPECT_EQ(Numbers(CompareAppearance(table, Grey(-5), Quick())),
            Numbers(CompareAppearance(table, Grey(0), Quick())));
}

TEST(CompareAppearance, LeavesOutWhatWasNotMeasured) {
  BrdfTable table = Plastic();
  // The values there are worthless, and no way to tell but by the marks.
  Unmeasure([](const HalfDiffAngles& angles) { return angles.theta_d > DegreesToRadians(55); },
            &table);
  const std::vector<bool> above = BinsAboveSurface(kGrid);
  int all = 0, beyond = 0;
  double steepest = 0;
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    all += above[bin] ? 1 : 0;
    if (!above[bin] || table.unmeasured[bin] == Unmeasured::kNo) continue;
    ++beyond;
    const Cosines cosines = ToCosines(kGrid.Center(bin));
    steepest = std::max({steepest, cosines.i, cosines.o});
    for (int c = 0; c < kChannels; ++c) table.SetValue(c, bin, 7);
  }
  const TabulatedBrdf brdf(table);
  const std::vector<Unmeasured> marks = table.unmeasured;  // which the table will lose
  const AngularBrdf fitted = [&](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
    const int bin = kGrid.Bin(angles);
    if (above[bin] && marks[bin] != Unmeasured::kNo) return Rgb{10, 1000, 100};
    return brdf.Interpolate(angles);
  };
  const AppearanceReport report = CompareAppearance(table, fitted, Quick());
  ExpectNoDifference(report, 0);
  ASSERT_TRUE(report.beyond);
  EXPECT_NEAR(report.beyond->share, static_cast<double>(beyond) / all, 1e-12);
  EXPECT_LE(report.beyond->largest, 1000 * steepest);
  EXPECT_GT(report.beyond->largest, 900 * steepest);  // it looks at every fifth phi_d
  EXPECT_GT(report.beyond->largest_within, 0);
  EXPECT_LT(report.beyond->largest_within, 100);
  EXPECT_LT(report.beyond->psnr_db, 20);
  // Had the marks been missed, so would the sphere.
  table.unmeasured.clear();
  EXPECT_LT(CompareAppearance(table, fitted, Quick()).sphere.psnr_db, 20);
}

// Bins whose centre is below the surface have no sample to tell by, but those around them.
TEST(CompareAppearance, LeavesOutTheHorizonWhereNothingAroundItWasMeasured) {
  BrdfTable table = Plastic();
  const auto steep = [](const HalfDiffAngles& angles) {
    const Cosines cosines = ToCosines(angles);
    return std::min(cosines.i, cosines.o) < std::cos(DegreesToRadians(60));
  };
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    if (steep(kGrid.Center(bin))) table.SetValue(0, bin, -1);
  }
  const TabulatedBrdf brdf(table);
  const AngularBrdf fitted = [&](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
    return steep(kGrid.Center(kGrid.Bin(angles))) ? Rgb{50, 50, 50} : brdf.Interpolate(angles);
  };
  EXPECT_EQ(CompareAppearance(table, fitted, Quick()).sphere.psnr_db, kInfinity);
}

TEST(CompareAppearance, LeavesOutAnglesBeyondTheLargestMeasured) {
  BrdfTable table = Plastic();
  table.max_theta = DegreesToRadians(70);
  const double least = std::cos(table.max_theta);
  const auto grazing = [&](const Cosines& cosines) {
    return std::min(cosines.i, cosines.o) < least;
  };
  Unmeasure([&](const HalfDiffAngles& angles) { return grazing(ToCosines(angles)); }, &table);
  const TabulatedBrdf brdf(table);
  const AngularBrdf fitted = [&](const HalfDiffAngles& angles, const Cosines& cosines) {
    return grazing(cosines) ? Rgb{50, 50, 50} : brdf.Interpolate(angles);
  };
  const AppearanceReport report = CompareAppearance(table, fitted, Quick());
  EXPECT_EQ(report.sphere.psnr_db, kInfinity);
  EXPECT_EQ(report.albedo.max, 0);
  EXPECT_EQ(report.albedo.measured.back(), Rgb{});  // at 75 degrees nothing was measured
  EXPECT_EQ(report.at_centers.log, 0);
  ASSERT_TRUE(report.beyond);
  EXPECT_GT(report.beyond->largest, 10);
  EXPECT_LT(report.beyond->psnr_db, 40);
}

TEST(CompareAppearance, ABlackMeasurementHasNumbersToo) {
  const BrdfTable black = Constant(0);
  ExpectNoDifference(CompareAppearance(black, Grey(0), Quick()), 0);
  const AppearanceReport report = CompareAppearance(black, Grey(0.1), Quick());
  for (const double x : Numbers(report)) EXPECT_TRUE(std::isfinite(x)) << x;
  EXPECT_LT(report.sphere.psnr_db, 3);
  EXPECT_GT(report.sphere.mean_delta_e, 50);
  EXPECT_NEAR(report.albedo.mean, 0.1 * kPi, 1e-3);
  EXPECT_NEAR(report.at_centers.relative, 100, 1e-9);
}

TEST(CompareAppearance, OverflowIsAnError) {
  const BrdfTable table = Plastic();
  for (const double bad : {1e308, kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(ErrorFrom(table, Grey(bad)),
                IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}))
        << bad;
  }
  // The overflow is beyond the data only.
  BrdfTable part = table;
  Unmeasure([](const HalfDiffAngles& angles) { return angles.theta_d > 1; }, &part);
  const AngularBrdf unbounded = [](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
    return angles.theta_d > 1 ? Rgb{1, kInfinity, 1} : Rgb{1, 1, 1};
  };
  EXPECT_THAT(ErrorFrom(part, unbounded),
              IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}));
}

TEST(CompareAppearance, NothingToCompareIsAnError) {
  EXPECT_THAT(ErrorFrom(MakeInvalidTable("lost", kGrid), Grey(1)),
              IsError(ErrorKind::kData, {.key = "bins"}));
  const Environment night{"night", 4, 2, std::vector<Rgb>(8)};
  AppearanceOptions options = Quick();
  options.environment = &night;
  EXPECT_THAT(ErrorFrom(Plastic(), Grey(1), options),
              IsError(ErrorKind::kData, {.file = "night", .key = "radiance", .value = "0"}));
}

TEST(CompareAppearance, IsTheSameForAnyNumberOfThreads) {
  BrdfTable table = Plastic();
  Unmeasure([](const HalfDiffAngles& angles) { return angles.theta_d > 1.2; }, &table);
  const AngularBrdf fitted = [](const HalfDiffAngles& angles, const Cosines& cosines) {
    return Rgb{0.1 + angles.theta_h, 0.2 * cosines.i, 0.3 * cosines.o};
  };
  const std::vector<double> one = Numbers(CompareAppearance(table, fitted, Quick(1)));
  EXPECT_EQ(Numbers(CompareAppearance(table, fitted, Quick(2))), one);
  EXPECT_EQ(Numbers(CompareAppearance(table, fitted, Quick(3))), one);
}

// --- Pictures -----------------------------------------------------------------------------------

TEST(RenderPicture, ShowsAllAndTellsWhatWasMeasured) {
  BrdfTable table = Plastic();
  const ImagePairs all = RenderPicture(table, Grey(0.1), Quick());
  for (const double x : all.whole.measured.coverage) EXPECT_TRUE(x == 1 || x < 0) << x;
  EXPECT_EQ(all.counted.measured.radiance, all.whole.measured.radiance);
  Unmeasure([](const HalfDiffAngles& angles) { return angles.theta_d > 0.8; }, &table);
  const ImagePairs part = RenderPicture(table, Grey(0.1), Quick());
  EXPECT_EQ(part.whole.fitted.radiance, all.whole.fitted.radiance);
  EXPECT_EQ(part.whole.measured.coverage, part.counted.fitted.coverage);
  int partly = 0;
  for (size_t k = 0; k < part.whole.measured.coverage.size(); ++k) {
    const double x = part.whole.measured.coverage[k];
    ASSERT_LE(x, 1);
    ASSERT_EQ(x < 0, all.whole.measured.coverage[k] < 0);
    partly += x > 0.01 && x < 0.99;
    if (x >= 0) {
      EXPECT_GT(part.whole.measured.radiance[k][0], 0);
    }
  }
  EXPECT_GT(partly, 100);
}

// Bins that were lost here and there leave no dark flecks: where they are read, the nearest are.
TEST(RenderPicture, HasNoFlecksWhereBinsWereLost) {
  BrdfTable table = Plastic();
  const ImagePair whole = RenderPicture(table, Grey(0.1), Quick()).whole;
  Random random(1);
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    if (random.Uniform() < 0.1) table.stored[0][bin] = -1;
  }
  const ImagePair lost = RenderPicture(table, Grey(0.1), Quick()).whole;
  for (size_t k = 0; k < whole.measured.radiance.size(); ++k) {
    EXPECT_NEAR(lost.measured.radiance[k][1], whole.measured.radiance[k][1],
                0.15 * whole.measured.radiance[k][1]);
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
