#include "fit/finish/node_residual.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "trilobe/core/base/error.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr HemisphereGrid kGrid = {6, 12};

// A Lambertian model of 0.1, and data that are more than that by these.
std::optional<NodeBrdf> ResidualBy(const std::function<double(const SphericalAngles&)>& more,
                                   const HemisphereGrid& grid = kGrid) {
  BrdfSamples samples = SamplesOf(SynthesizeSamples(FindSynthMaterial("velvet"), 0, 1, kGrid));
  for (int j = 0; j < samples.size(); ++j) {
    samples.rho[j].fill(0.1 + more(samples.directions[j]));
  }
  FactorModel model(ModelSpec{.lobes = 0});
  for (double& d : model.d()) d = 0.1;
  return InterpolateResidual(
      model, Objective(std::move(samples), model.spec(), Weightings().front(), 2), grid);
}

TEST(InterpolateResidual, OfWideHighlightsIsInterpolated) {
  const auto wide = [](const SphericalAngles& at) {
    return -0.05 + 0.02 * (at.theta_i + at.theta_o);
  };
  const std::optional<NodeBrdf> residual = ResidualBy(wide);
  ASSERT_TRUE(residual);
  const SphericalAngles between{0.3, 0.2, 0.9, 2.9};
  for (const double x : (*residual)(between)) EXPECT_NEAR(x, wide(between), 1e-12);
}

// It changes its sign from each theta_i to the next.
TEST(InterpolateResidual, OfHighlightsNarrowerThanTheStepsIsNot) {
  const double step = kGrid.ThetaStep();
  EXPECT_FALSE(ResidualBy(
      [&](const SphericalAngles& at) { return 0.05 * std::cos(kPi * at.theta_i / step); }));
  EXPECT_FALSE(ResidualBy([](const SphericalAngles&) { return 0; }));
}

TEST(InterpolateResidual, WantsSamplesAtItsNodes) {
  EXPECT_THAT(ErrorOf([&] {
                ResidualBy([](const SphericalAngles&) { return 0; }, {5, 12});
              }),
              IsError(ErrorKind::kMismatch, {.key = "grid"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
