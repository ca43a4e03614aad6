#include "trilobe/model/objective/lobe_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/objective/gauge.h"
#include "tests/test_util.h"
#include "trilobe/model/measurement/albedo.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 45, .theta_d = 30, .phi_d = 36};

std::vector<double> AllObserved(const FactorModel& model) {
  return std::vector<double>(model.parameters().size(), 1.0);
}

// Smooth tables, as the integrals of the test are coarse. d and two lobes.
FactorModel SmoothModel() {
  FactorModel model(ModelSpec::SharedFactors(2, kGrid));
  for (int c = 0; c < kChannels; ++c) {
    model.d()[c] = 0.1 * (c + 1);
    for (int m = 0; m < 2; ++m) model.s(m)[c] = 0.2 + 0.1 * m * c;
  }
  for (int m = 0; m < 2; ++m) {
    const auto D = model.table(Factor::kD, m);
    for (int h = 0; h < kGrid.theta_h; ++h) {
      D[h] = std::exp(-4 * (m + 1) * kGrid.ThetaH(h + 0.5) * kGrid.ThetaH(h + 0.5));
    }
    const auto G = model.table(Factor::kG, m);
    for (size_t k = 0; k < G.size(); ++k) {
      G[k] = std::cos((static_cast<double>(k) + 0.5) / static_cast<double>(G.size()) * kPi / 2);
    }
  }
  for (int t = 0; t < 3; ++t) {
    const auto F = model.table(Factor::kF, t);
    for (int d = 0; d < kGrid.theta_d; ++d) F[d] = 0.3 + 0.1 * t + 0.5 * std::pow(d / 30.0, 3);
  }
  return model;
}

// The mean of the directional albedos over the projected hemisphere, of a model without the other
// parts.
Rgb BihemisphericalAlbedo(const FactorModel& model) {
  constexpr int kSteps = 24;
  const auto brdf = [&](const DirectionPair& pair) { return Evaluate(model, pair); };
  Rgb sum{};
  for (int k = 0; k < kSteps; ++k) {
    const double sin2 = (k + 0.5) / kSteps;  // equal shares of the projected hemisphere
    const Rgb albedo = DirectionalAlbedo(brdf, std::asin(std::sqrt(sin2)));
    for (int c = 0; c < kChannels; ++c) sum[c] += albedo[c] / kSteps;
  }
  return sum;
}

TEST(LobeLight, AgreesWithTheDirectionalAlbedosOfEachPart) {
  const FactorModel model = SmoothModel();
  const LobeLight light = ComputeLobeLight(AllObserved(model), model);
  FactorModel part = model;
  for (double& s : part.s(0)) s = 0;
  for (double& s : part.s(1)) s = 0;
  Rgb expected = BihemisphericalAlbedo(part);
  double total = 0;
  for (int c = 0; c < kChannels; ++c) {
    EXPECT_NEAR(light.diffuse[c], kPi * model.d()[c], 1e-12);
    EXPECT_NEAR(light.diffuse[c], expected[c], 2e-3 * expected[c]);
    total += light.diffuse[c];
  }
  for (int m = 0; m < 2; ++m) {
    part = model;
    for (double& d : part.d()) d = 0;
    for (double& s : part.s(1 - m)) s = 0;
    expected = BihemisphericalAlbedo(part);
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(light.lobes[m][c], expected[c], 0.02 * expected[c]) << m;
      total += light.lobes[m][c];
    }
  }
  EXPECT_NEAR(light.Share(0) + light.Share(1) + light.DiffuseShare(), 1, 1e-12);
  EXPECT_NEAR(light.Share(1), (light.lobes[1][0] + light.lobes[1][1] + light.lobes[1][2]) / total,
              1e-12);
}

// Rings of D are bins of theta_h, or nodes over azimuths.
TEST(LobeLight, SameBitsForAnyNumberOfThreads) {
  FactorModel anisotropic(ModelSpec::Anisotropic(2));
  for (double& x : anisotropic.parameters()) x = 0.5;
  for (const FactorModel& model : {SmoothModel(), anisotropic}) {
    const LobeLight one = ComputeLobeLight(AllObserved(model), model, 1);
    EXPECT_GT(one.Share(1), 0);
    for (const int threads : {2, 3}) {
      const LobeLight other = ComputeLobeLight(AllObserved(model), model, threads);
      EXPECT_EQ(one.diffuse, other.diffuse);
      EXPECT_EQ(one.lobes, other.lobes);
      EXPECT_EQ(one.through, other.through);
    }
  }
}

// Four times s is the albedo of a lobe with constant F and G and a D of integral 1: there G is 1,
// but for the steps of the integral.
TEST(LobeLight, WithConstantFactorsTheCanonicalOnesAreOne) {
  FactorModel model = SmoothModel();
  for (double& d : model.d()) d = 0;
  for (int t = 0; t < 3; ++t) std::ranges::fill(model.table(Factor::kF, t), 2.0);
  for (int m = 0; m < 2; ++m) std::ranges::fill(model.table(Factor::kG, m), 3.0);
  Canonicalize(AllObserved(model), &model);
  const LobeLight light = ComputeLobeLight(AllObserved(model), model);
  for (int m = 0; m < 2; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(light.lobes[m][c], 4 * model.s(m)[c], 1e-12 * light.lobes[m][c]);
    }
    for (const double G : model.table(Factor::kG, m)) EXPECT_NEAR(G, 1, 0.01);
  }
  for (const double F : model.table(Factor::kF, 1)) EXPECT_NEAR(F, 1, 1e-12);
}

TEST(LobeLight, DoesNotDependOnTheGauge) {
  const FactorModel model = SmoothModel();
  FactorModel other = model;
  for (double& x : other.table(Factor::kD, 0)) x *= 1e6;
  for (double& s : other.s(0)) s *= 1e-6;
  const LobeLight a = ComputeLobeLight(AllObserved(model), model);
  const LobeLight b = ComputeLobeLight(AllObserved(model), other);
  for (int m = 0; m < 2; ++m) {
    EXPECT_NEAR(a.Share(m), b.Share(m), 1e-13);
    for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(a.lobes[m][c], b.lobes[m][c], 1e-13);
  }
}

TEST(LobeLight, LeavesOutUnobservedEntriesAndBlackModels) {
  FactorModel model = SmoothModel();
  std::vector<double> observed = AllObserved(model);
  for (int m = 0; m < 2; ++m) observed[model.TableOffset(Factor::kD, m)] = 0;
  const LobeLight light = ComputeLobeLight(observed, model);
  EXPECT_EQ(light.through[model.TableOffset(Factor::kD, 0)], 0);
  EXPECT_GT(light.through[model.TableOffset(Factor::kD, 0) + 1], 0);

  for (double& x : model.parameters()) x = 0;
  const LobeLight black = ComputeLobeLight(AllObserved(model), model);
  EXPECT_EQ(black.Share(0), 0);
  EXPECT_EQ(black.DiffuseShare(), 0);
}

// Near the normal all pairs are above the surface; a grazing half vector leaves hardly any.
TEST(LobeLight, VisibleSolidAnglesFallTowardsGrazing) {
  const std::vector<double> angles = VisibleSolidAngles(90);
  const MerlGrid grid;
  double before = 1;
  for (int h = 0; h < 90; ++h) {
    const double full =
        2 * kPi * std::sin(grid.ThetaH(h + 0.5)) * (grid.ThetaH(h + 1) - grid.ThetaH(h));
    const double visible = angles[h] / full;
    EXPECT_LE(visible, before);
    before = visible;
  }
  EXPECT_NEAR(angles[0], 2 * kPi * std::sin(grid.ThetaH(0.5)) * grid.ThetaH(1), 1e-3 * angles[0]);
  EXPECT_LT(before, 0.05);
}

TEST(LobeLightTest, KnowsALobeThatIsNearlyDiffuse) {
  FactorModel model = SmoothModel();
  const auto found = [&] { return ComputeLobeLight(AllObserved(model), model).nearly_diffuse; };
  EXPECT_EQ(found(), std::vector<bool>({false, false}));   // D falls
  std::ranges::fill(model.table(Factor::kD, 1), 1 / kPi);  // and G is cos theta
  EXPECT_EQ(found(), std::vector<bool>({false, true}));
  std::ranges::fill(model.table(Factor::kG, 1), 1.0);  // brighter towards grazing
  EXPECT_EQ(found(), std::vector<bool>({false, false}));
  std::ranges::fill(model.table(Factor::kD, 1), 0.0);
  EXPECT_EQ(found(), std::vector<bool>({false, false}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
