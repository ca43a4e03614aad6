#include "fit/scene/scene_judge.h"

#include <gtest/gtest.h>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 7, .phi_d = 12};

double Luminance(const Rgb& rho) { return 0.2126 * rho[0] + 0.7152 * rho[1] + 0.0722 * rho[2]; }

TEST(Luminance, OfSamplesIsGrey) {
  const BrdfSamples samples = ValidSamples(RandomTable(kGrid, 1));
  const BrdfSamples grey = LuminanceOf(samples);
  ASSERT_EQ(grey.bins, samples.bins);
  for (int j = 0; j < samples.size(); ++j) {
    for (int c = 0; c < kChannels; ++c) EXPECT_DOUBLE_EQ(grey.rho[j][c], Luminance(samples.rho[j]));
  }
}

TEST(Luminance, OfAModelIsThatOfItsValues) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const FactorModel model = RandomModel(spec, 2);
    if (spec.D.per_channel || spec.G.per_channel) {
      EXPECT_THAT(ErrorOf([&] { LuminanceOf(model); }),
                  IsError(ErrorKind::kUnsupported, {.key = "luminance"}))
          << name;
      continue;
    }
    const FactorModel grey = LuminanceOf(model);
    for (const int bin : ValidSamples(RandomTable(kGrid, 3)).bins) {
      const SampleStencils at = GridStencils(spec, kGrid, bin);
      const Rgb rho = {UnclampedValue(model, at, 0), UnclampedValue(model, at, 1),
                       UnclampedValue(model, at, 2)};
      for (int c = 0; c < kChannels; ++c) {
        // A handful of additions and products of parameters >= 0, but for the spline's own weights.
        EXPECT_NEAR(UnclampedValue(grey, at, c), Luminance(rho), 1e-13 * (1 + Luminance(rho)))
            << name;
      }
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
