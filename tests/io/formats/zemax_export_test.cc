#include "io/formats/exports/zemax_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "io/formats/optical/zemax_angles.h"
#include "io/formats/spectrum.h"
#include "tests/error_of.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"
#include "trilobe/model/measurement/albedo.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

ExportedBrdf True(bool anisotropic) {
  const PairBrdf brdf = TrueMaterial(anisotropic).brdf;
  std::vector<CompletedMeasurement::Place> places;
  for (const double theta : {10.0, 30.0, 50.0}) {
    for (const double phi : {0.0, 100.0, 200.0}) {
      const SphericalAngles at = {DegreesToRadians(40), DegreesToRadians(phi),
                                  DegreesToRadians(theta), DegreesToRadians(phi + 170)};
      places.push_back({ToDirections(at), brdf(ToDirections(at))});
    }
  }
  return {brdf, anisotropic, places};
}

// The numbers after each word.
std::vector<double> NumbersAfter(const std::string& text, const std::string& word) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string next; words >> next;) {
    if (next != word) continue;
    words >> next;
    numbers.push_back(std::stod(next));
  }
  return numbers;
}

TEST(ZemaxExport, OurReaderReadsBackTheMaterial) {
  const ZemaxExport file = ExportZemax(True(false), {.max_error = 0.1});
  EXPECT_TRUE(file.colored);
  EXPECT_THAT(file.bytes, HasSubstr("Symmetry\tPlaneSymmetrical\nSpectralContent\tXYZ\n"));
  const Measurement measurement = ReadAs("zemax", file.bytes, "x.bsdf");
  EXPECT_FALSE(measurement.anisotropic);
  EXPECT_EQ(measurement.counts.total, file.incidences * (file.azimuths * (file.radials - 1) + 1));
  EXPECT_EQ(measurement.counts.total, measurement.counts.valid + measurement.counts.below_surface);
  ExpectTruth(measurement, /*grey=*/false, /*anisotropic=*/false, /*tolerance=*/3e-5);
}

TEST(ZemaxExport, AnisotropicOnesHaveRotations) {
  const ZemaxExport file = ExportZemax(True(true), {.max_error = 1});
  EXPECT_EQ(file.rotations, 13);
  EXPECT_THAT(file.bytes, HasSubstr("Symmetry\tAsymmetrical4D\n"));
  const Measurement measurement = ReadAs("zemax", file.bytes, "x.bsdf");
  EXPECT_TRUE(measurement.anisotropic);
  ExpectTruth(measurement, /*grey=*/false, /*anisotropic=*/true, /*tolerance=*/3e-5);
}

TEST(ZemaxExport, GreysHaveOneChannelAndTheirAlbedo) {
  ExportedBrdf grey = True(false);
  grey.value = [](const DirectionPair& /*pair*/) { return Rgb{0.25, 0.25, 0.25}; };
  for (CompletedMeasurement::Place& place : grey.places) place.measured = {0.25, 0.25, 0.25};
  const ZemaxExport file = ExportZemax(grey);
  EXPECT_FALSE(file.colored);
  EXPECT_LT(file.high_error, 1e-9);
  EXPECT_THAT(file.bytes, HasSubstr("\nMonochrome\nDataBegin\nTIS"));
  const std::vector<double> tis = NumbersAfter(file.bytes, "TIS");
  EXPECT_EQ(tis.size(), file.incidences);
  for (const double albedo : tis) EXPECT_NEAR(albedo, kPi / 4, 1e-3);
}

TEST(ZemaxExport, TisIsTheAlbedoOfEachIncidenceAndChannel) {
  const ZemaxExport file = ExportZemax(True(false), {.max_error = 1});
  const std::vector<double> tis = NumbersAfter(file.bytes, "TIS");
  ASSERT_EQ(tis.size(), 3 * file.incidences);
  for (int k = 0; k < file.incidences - 1; ++k) {
    const Rgb albedo = DirectionalAlbedo(TrueMaterial().brdf, kPi / 2 * k / (file.incidences - 1));
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(tis[c * file.incidences + k], TristimulusOf(albedo)[c], 2e-5);
    }
  }
}

// Integrates the values as a program does that draws from the table.
TEST(ZemaxExport, ValuesReflectTheLightOfTheMaterial) {
  const Measurement measurement =
      ReadAs("zemax", ExportZemax(True(false), {.max_error = 1e-3}).bytes, "x.bsdf");
  double light = 0, expected = 0;
  const double incidence = DegreesToRadians(40);
  std::vector<std::pair<double, double>> radials;  // distance, mean over azimuths of f cos theta_o
  for (int j = 0; j < measurement.samples.size(); ++j) {
    const SphericalAngles& at = measurement.samples.directions[j];
    if (std::abs(at.theta_i - incidence) > 1e-6) continue;
    const ZemaxAngles angles = ToZemaxAngles(ToDirections(at));
    const bool at_end = angles.azimuth < 1e-6 || angles.azimuth > kPi - 1e-6;
    const double value = measurement.samples.rho[j][1] * std::cos(at.theta_o) * (at_end ? 0.5 : 1);
    if (angles.radial < 1e-6) continue;
    const auto same = std::ranges::find_if(
        radials, [&](const auto& one) { return std::abs(one.first - angles.radial) < 1e-9; });
    if (same == radials.end()) {
      radials.emplace_back(angles.radial, value);
    } else {
      same->second += value;
    }
  }
  std::ranges::sort(radials);
  const int azimuths = 91;
  for (size_t k = 0; k + 1 < radials.size(); ++k) {
    const auto at = [&](size_t r) { return radials[r].second * std::sin(radials[r].first); };
    light += (at(k) + at(k + 1)) / 2 * (radials[k + 1].first - radials[k].first) * 2 * kPi /
             (azimuths - 1);
  }
  expected = DirectionalAlbedo(TrueMaterial().brdf, incidence)[1];
  EXPECT_NEAR(light, expected, 0.01 * expected);
}

TEST(ZemaxExport, FinerTablesAreNearer) {
  const ExportedBrdf brdf = True(false);
  const ZemaxExport coarse = ExportZemax(brdf, {.max_error = 1});
  const ZemaxExport fine = ExportZemax(brdf);
  EXPECT_LE(fine.median_error, 0.005);
  EXPECT_LT(fine.median_error, coarse.median_error);
  EXPECT_GT(fine.bytes.size(), coarse.bytes.size());
  EXPECT_THAT(ErrorOf([&] { ExportZemax(brdf, {.max_error = 0}); }),
              IsError(ErrorKind::kLimit, {.key = "max_error", .value = "0"}));
  EXPECT_THAT(ErrorOf([&] {
                ExportZemax({brdf.value, false, {}});
              }),
              IsError(ErrorKind::kData, {.key = "light"}));
}

TEST(ZemaxAngles, TurnIntoDirectionsAndBack) {
  for (const double rotation : {0.0, 1.0, 4.0}) {
    for (const double incidence : {0.1, 0.7}) {
      for (const double azimuth : {0.2, 2.0, 5.0}) {
        const ZemaxAngles at = {rotation, incidence, azimuth, 0.6};
        const ZemaxAngles back = ToZemaxAngles(ToDirections(ToSphericalAngles(at)));
        EXPECT_NEAR(back.rotation, rotation, 1e-12);
        EXPECT_NEAR(back.incidence, incidence, 1e-12);
        EXPECT_NEAR(back.azimuth, azimuth, 1e-12);
        EXPECT_NEAR(back.radial, 0.6, 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
