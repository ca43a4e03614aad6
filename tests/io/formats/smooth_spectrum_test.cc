#include "io/formats/smooth_spectrum.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "io/formats/spectrum.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

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
    const double size = std::exp(random.Uniform(-12, 8));  // as BRDFs are, beyond 1
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
