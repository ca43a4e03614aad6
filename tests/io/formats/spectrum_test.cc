#include "io/formats/spectrum.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

std::vector<double> Wavelengths(double first, double last, double step) {
  std::vector<double> wavelengths;
  for (double x = first; x <= last + 1e-9; x += step) wavelengths.push_back(x);
  return wavelengths;
}

// CIE XYZ of linear sRGB (IEC 61966-2-1, Annex).
std::array<double, 3> ToXyz(const Rgb& rgb) {
  return {0.4124564 * rgb[0] + 0.3575761 * rgb[1] + 0.1804375 * rgb[2],
          0.2126729 * rgb[0] + 0.7151522 * rgb[1] + 0.0721750 * rgb[2],
          0.0193339 * rgb[0] + 0.1191920 * rgb[1] + 0.9503041 * rgb[2]};
}

// The colour of light of one wavelength: a band of 5 nm.
std::array<double, 3> XyzAt(double wavelength) {
  const std::vector<double> wavelengths = Wavelengths(380, 780, 5);
  std::vector<double> spectrum(wavelengths.size());
  for (size_t k = 0; k < spectrum.size(); ++k) spectrum[k] = wavelengths[k] == wavelength;
  return ToXyz(SpectralColor(wavelengths, "test")(spectrum));
}

TEST(SpectralColor, HasThePublishedSpectralLocus) {
  struct Point {
    double wavelength, x, y;
  };
  // CIE 15:2004, table T.4.
  for (const Point& point :
       {Point{450, 0.1566, 0.0177}, Point{480, 0.0913, 0.1327}, Point{520, 0.0743, 0.8338},
        Point{550, 0.3016, 0.6923}, Point{600, 0.6270, 0.3725}, Point{650, 0.7260, 0.2740}}) {
    const auto [x, y, z] = XyzAt(point.wavelength);
    EXPECT_NEAR(x / (x + y + z), point.x, 5e-4) << point.wavelength;
    EXPECT_NEAR(y / (x + y + z), point.y, 5e-4) << point.wavelength;
  }
}

TEST(SpectralColor, IsLitByD65) {
  // Power (table T.1) times y-bar, relative to 560 nm.
  EXPECT_NEAR(XyzAt(450)[1] / XyzAt(560)[1], 117.008 * 0.038 / 99.5, 1e-4);
  EXPECT_NEAR(XyzAt(600)[1] / XyzAt(560)[1], 90.0062 * 0.631 / 99.5, 1e-4);
  EXPECT_NEAR(XyzAt(650)[1] / XyzAt(560)[1], 80.0268 * 0.107 / 99.5, 1e-4);
}

TEST(SpectralColor, AConstantSpectrumIsGreyOnAnyWavelengths) {
  for (const auto& wavelengths : {Wavelengths(400, 700, 10), Wavelengths(380, 780, 1),
                                  std::vector<double>{431, 455, 500.5, 540, 590, 640, 655}}) {
    const std::vector<double> spectrum(wavelengths.size(), 0.3);
    for (const double x : SpectralColor(wavelengths, "test")(spectrum)) EXPECT_NEAR(x, 0.3, 1e-15);
  }
}

TEST(SpectralColor, TakesASpectrumAsLinearBetweenAndConstantBeyondWavelengths) {
  const auto coarse = Wavelengths(400, 700, 50), fine = Wavelengths(380, 780, 5);
  const auto at = [](double x) { return 1 + 0.01 * (std::clamp(x, 400.0, 700.0) - 400); };
  std::vector<double> few, many;
  for (const double x : coarse) few.push_back(at(x));
  for (const double x : fine) many.push_back(at(x));
  const Rgb a = SpectralColor(coarse, "test")(few), b = SpectralColor(fine, "test")(many);
  for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(a[c], b[c], 1e-12);
}

TEST(SpectralColor, NegativeChannelsAreCountedAndBecomeZero) {
  const auto wavelengths = Wavelengths(400, 700, 10);
  const SpectralColor color(wavelengths, "test");
  std::vector<double> spectrum(wavelengths.size());
  spectrum[12] = 1;  // 520 nm, which sRGB cannot show
  ASSERT_LT(color(spectrum)[0], 0);
  SampleCollector collector("test", "test");
  AddSpectrum({}, spectrum, color, &collector);
  AddSpectrum({.theta_i = 2}, spectrum, color, &collector);  // below the surface
  spectrum[3] = -1e-6;  // noise, which makes the whole spectrum invalid
  AddSpectrum({}, spectrum, color, &collector);
  const Measurement measurement = collector.Take();
  EXPECT_EQ(measurement.counts.total, 3);
  EXPECT_EQ(measurement.counts.valid, 1);
  EXPECT_EQ(measurement.counts.below_surface, 1);
  EXPECT_EQ(measurement.counts.negative, 1);
  EXPECT_EQ(measurement.out_of_gamut, 1);
  EXPECT_EQ(measurement.samples.rho[0][0], 0);
  EXPECT_GT(measurement.samples.rho[0][1], 0);
}

TEST(SpectralColor, RejectsWavelengthsThatMakeNoColour) {
  const auto error = [](const std::vector<double>& wavelengths) {
    return ErrorOf([&] { SpectralColor(wavelengths, "x.brdf"); });
  };
  EXPECT_THAT(error({400, 450, 440}),
              IsError(ErrorKind::kRange, {.file = "x.brdf", .key = "wavelengths", .value = "440"}));
  EXPECT_THAT(error({400, 450, 550, 600, 650}),
              IsError(ErrorKind::kMissing, {.key = "wavelengths", .value = "550"}));
  EXPECT_THAT(error({633}), IsError(ErrorKind::kMissing, {.key = "wavelengths", .value = "633"}));
  EXPECT_THAT(error({}), IsError(ErrorKind::kMissing, {.key = "wavelengths", .value = "0"}));
}

std::vector<double> Wavelengths() {
  std::vector<double> wavelengths;
  for (int k = 0; k < 16; ++k) wavelengths.push_back(400 + 20 * k);
  return wavelengths;
}

TEST(SmoothSpectra, HaveTheColoursAskedFor) {
  const std::vector<double> wavelengths = Wavelengths();
  SmoothSpectra spectra(wavelengths);
  const SpectralColor color(wavelengths, "test");
  Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const double size = std::exp(random.Uniform(-12, 8));  // BRDFs exceed 1
    const Rgb rgb = {size * random.Uniform(0.2, 1), size * random.Uniform(0.2, 1),
                     size * random.Uniform(0.2, 1)};
    const auto spectrum = spectra(rgb);
    EXPECT_LT(spectra.error(), 1e-5);
    EXPECT_LT(RelativeDistance(color(spectrum), rgb), 1e-5);
    const double largest = std::max({rgb[0], rgb[1], rgb[2]});
    for (const double value : spectrum) {
      EXPECT_GE(value, 0);
      EXPECT_LE(value, 2 * largest);
    }
  }
}

TEST(SmoothSpectra, OfGreysAreConstant) {
  SmoothSpectra spectra(Wavelengths());
  spectra({0.9, 0.2, 0.1});  // whatever was asked before
  for (const double value : spectra({3, 3, 3})) EXPECT_NEAR(value, 3, 1e-4);
  for (const double value : spectra({0, 0, 0})) EXPECT_EQ(value, 0);
  for (const double value : spectra({-1, 0, 0})) EXPECT_EQ(value, 0);
}

TEST(SmoothSpectra, AreSmooth) {
  SmoothSpectra spectra(Wavelengths());
  const auto spectrum = spectra({0.3, 0.5, 0.2});
  // A sigmoid of a parabola turns once.
  int turns = 0;
  for (size_t k = 2; k < spectrum.size(); ++k) {
    turns += (spectrum[k] - spectrum[k - 1]) * (spectrum[k - 1] - spectrum[k - 2]) < 0;
  }
  EXPECT_LE(turns, 1);
}

// No spectrum has the primaries' colours in half of its scale; what is said of them is true, and
// they do not lead the next colours astray.
TEST(SmoothSpectra, SaturatedColoursAreMetAsFarAsTheyCanBe) {
  const std::vector<double> wavelengths = Wavelengths();
  SmoothSpectra spectra(wavelengths);
  const SpectralColor color(wavelengths, "test");
  for (const Rgb& rgb : {Rgb{1, 0, 0}, Rgb{0, 1, 0}, Rgb{0, 0, 1}, Rgb{1, 1, 0}, Rgb{0, 1, 1},
                         Rgb{1, 0, 1}, Rgb{1, 1e-9, 0.5}}) {
    const auto spectrum = spectra(rgb);
    for (const double value : spectrum) EXPECT_TRUE(std::isfinite(value));
    EXPECT_NEAR(RelativeDistance(color(spectrum), rgb), spectra.error(), 1e-6);
    EXPECT_LT(spectra.error(), 0.1);
    spectra({0.5, 0.4, 0.3});
    EXPECT_LT(spectra.error(), 1e-5);
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
