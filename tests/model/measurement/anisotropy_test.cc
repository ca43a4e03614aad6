#include "model/measurement/anisotropy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/measurement/counter_random.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/hemisphere_grid.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// rho = 1 + a cos(2 phi_i) in red and 1 elsewhere: of the energy 3 + a^2 / 2 the mean over all
// turns has 3, at each pair of theta.
TEST(Anisotropy, IsTheEnergyThatTheMeanLeavesOut) {
  constexpr double kA = 0.5;
  const HemisphereGrid grid;
  SampleCollector collector("x", "made");
  for (int i = 0; i < grid.nodes(); ++i) {
    for (int o = 0; o < grid.nodes(); ++o) {
      collector.Add(grid.Angles(i, o), {1 + kA * std::cos(2 * grid.Phi(i)), 1, 1});
    }
  }
  collector.Add({0.1, 0, 0.2, 0}, {1e6, 1e6, 1e6});  // has no other
  const Anisotropy anisotropy = AnisotropyOf(collector.Take());
  EXPECT_EQ(anisotropy.samples, grid.nodes() * grid.nodes());
  EXPECT_NEAR(anisotropy.share, kA * kA / 2 / (3 + kA * kA / 2), 1e-12);
}

TEST(Anisotropy, WeighsByBothCosines) {
  SampleCollector collector("x", "made");
  const double theta = DegreesToRadians(60);
  for (const double phi : {0.0, 1.0}) {
    collector.Add({0, phi, 0, phi + 2}, {1, 1, 1});
    collector.Add({theta, phi, theta, phi + 2 - 2 * kPi}, {2 * phi, 2 * phi, 2 * phi});
  }
  // Energies 1, 1 and, by cos^2 60 cos^2 60 = 1/16, 0 and 4, of which the mean 1 leaves out 1
  // and 1.
  EXPECT_NEAR(AnisotropyOf(collector.Take()).share, (2 / 16.0) / (2 + 4 / 16.0), 1e-12);
}

// Noise of 10 % is 1 % of the energy, and of a wave of 10 %, a two-hundredth of it, nearly all is
// left: neighbours are 15 degrees apart, so that each product has cos 30 degrees of it.
TEST(Anisotropy, BeyondNoise) {
  const HemisphereGrid grid{.thetas = 6, .phis = 24};
  const auto share = [&](double wave) {
    SampleCollector collector("x", "made");
    for (int i = 0; i < grid.nodes(); ++i) {
      for (int o = 0; o < grid.nodes(); ++o) {
        const int j = grid.nodes() * i + o;
        const double noise = 0.1 * std::sqrt(12.0) * (UniformAt(1, j) - 0.5);
        const double rho = 1 + wave * std::cos(2 * grid.Phi(i)) + noise;
        collector.Add(grid.Angles(i, o), {rho, rho, rho});
      }
    }
    return AnisotropyOf(collector.Take());
  };
  const Anisotropy noise = share(0), both = share(0.1);
  EXPECT_EQ(noise.with_neighbours, noise.samples);
  EXPECT_NEAR(noise.share, 0.01, 0.002);
  EXPECT_LT(noise.smooth_share, noise.smooth_share_error);
  EXPECT_NEAR(both.smooth_share, 0.005 * std::cos(kPi / 6), 0.001);
  EXPECT_GT(both.smooth_share, both.smooth_share_error);
}

TEST(Anisotropy, OfSyntheticMaterials) {
  const auto share = [](const char* source) { return AnisotropyOf(LoadMeasurement(source)).share; };
  EXPECT_LT(share("synth:plastic@6x48"), 1e-20);
  EXPECT_LT(share("synth:enamelled_metal"), 0.01);
  EXPECT_GT(share("synth:charmeuse"), 0.05);
  EXPECT_GT(share("synth:velvet"), 0.2);
  EXPECT_EQ(AnisotropyOf(Measurement()).samples, 0);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
