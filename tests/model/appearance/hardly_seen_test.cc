#include "model/appearance/hardly_seen.h"

#include <gtest/gtest.h>

#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid = {.theta_h = 45, .theta_d = 45, .phi_d = 36};

TEST(HardlySeenTest, IsGrazingLightFarFromTheHighlight) {
  const BrdfTable plastic = Synthesize(FindSynthMaterial("plastic"), 0, 1, kGrid);
  const std::vector<bool> hardly = HardlySeen(plastic, plastic);
  const auto at = [&](double theta_h, double theta_d) {
    const int h = static_cast<int>(kGrid.ThetaHCoordinate(DegreesToRadians(theta_h)));
    return hardly[h * kGrid.theta_d +
                  static_cast<int>(kGrid.ThetaDCoordinate(DegreesToRadians(theta_d)))];
  };
  EXPECT_TRUE(at(60, 80));
  EXPECT_TRUE(at(80, 60));
  EXPECT_TRUE(at(80, 30));
  EXPECT_FALSE(at(0.1, 10));  // the middle of a highlight, of few directions
  EXPECT_FALSE(at(0.1, 80));
  EXPECT_FALSE(at(30, 30));
  EXPECT_FALSE(at(45, 20));
}

// A bin in which only the fit shines is seen.
TEST(HardlySeenTest, LooksAtTheFitToo) {
  const BrdfTable plastic = Synthesize(FindSynthMaterial("plastic"), 0, 1, kGrid);
  BrdfTable fitted = plastic;
  const std::vector<bool> hardly = HardlySeen(plastic, plastic);
  const std::vector<bool> valid = ValidBins(plastic);
  int bin = 0;
  while (!hardly[bin / kGrid.phi_d] || !valid[bin]) ++bin;
  const int first = bin / kGrid.phi_d;
  for (int p = 0; p < kGrid.phi_d; ++p) {
    for (int c = 0; c < kChannels; ++c) fitted.SetValue(c, first * kGrid.phi_d + p, 1e6);
  }
  EXPECT_FALSE(HardlySeen(plastic, fitted)[first]);
  EXPECT_FALSE(HardlySeen(fitted, plastic)[first]);
}

// The name holds: without these bins a material cannot be told apart from itself.
TEST(HardlySeenTest, CanBeLeftOut) {
  for (const char* name : {"plastic", "copper", "felt", "chrome", "car-paint"}) {
    const BrdfTable whole = Synthesize(FindSynthMaterial(name), 0, 1, kGrid);
    const std::vector<bool> hardly = HardlySeen(whole, whole);
    BrdfTable without = whole;
    for (int bin = 0; bin < kGrid.size(); ++bin) {
      if (!hardly[bin / kGrid.phi_d] || without.stored[0][bin] < 0) continue;
      for (int c = 0; c < kChannels; ++c) without.SetValue(c, bin, 0);
    }
    const TabulatedBrdf brdf(without);
    const AppearanceReport report = CompareAppearance(
        whole,
        [&](const HalfDiffAngles& at, const Cosines& /*cosines*/) { return brdf.Interpolate(at); },
        {});
    EXPECT_LT(report.sphere.mean_delta_e, 1) << name;
    EXPECT_LT(report.sphere.delta_e_95, 2.3) << name;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
