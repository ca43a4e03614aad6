#include "trilobe/model/appearance/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

Direction Normalized(const Direction& v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

std::vector<Light> TestLights() {
  Random random(3);
  std::vector<Light> lights;
  for (int k = 0; k < 30; ++k) {
    lights.push_back({Normalized({random.Normal(), random.Normal(), random.Normal()}),
                      {random.LogNormal(1), random.LogNormal(1), random.LogNormal(1)}});
  }
  return lights;
}

bool Everything(const SphericalAngles& /*at*/) { return true; }
bool Steep(const SphericalAngles& at) { return std::max(at.theta_i, at.theta_o) <= 1; }

void ExpectFrames(const View& view) {
  std::set<int> pixels;
  for (const auto& [pixel, x, y, normal] : view.points) {
    EXPECT_TRUE(pixels.insert(pixel).second);
    EXPECT_NEAR(Dot(x, x), 1, 1e-12);
    EXPECT_NEAR(Dot(normal, normal), 1, 1e-12);
    EXPECT_NEAR(Dot(x, normal), 0, 1e-12);
    const Direction cross = {normal[1] * x[2] - normal[2] * x[1],
                             normal[2] * x[0] - normal[0] * x[2],
                             normal[0] * x[1] - normal[1] * x[0]};
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(y[k], cross[k], 1e-12);
    EXPECT_GT(Dot(normal, kEye), 0);
  }
}

TEST(ViewSphere, HasItsParallelsAlongX) {
  const View view = ViewSphere(33);
  ExpectFrames(view);
  EXPECT_NEAR(static_cast<double>(view.points.size()), kPi / 4 * 33 * 33, 12);
  for (const SurfacePoint& point : view.points) {
    EXPECT_EQ(point.x[1], 0);
    EXPECT_GT(point.x[0], 0);
    EXPECT_GT(point.y[1], 0);
  }
}

// With one light the thread of one half is in the plane of light and normal, on flat parts at
// least, and that of the other half at right angles to it.
TEST(ViewCloth, TurnsTheThreadByAQuarterBetweenTheHalves) {
  const Light lights[] = {{Normalized({3, 1, 1}), {1, 1, 1}}};
  constexpr int kSize = 20;
  const View view = ViewCloth(kSize, lights);
  ExpectFrames(view);
  EXPECT_EQ(view.width, kSize);
  EXPECT_EQ(view.height, 2 * kSize);
  ASSERT_EQ(view.points.size(), 2U * kSize * kSize);
  double along = 0, across = 0, least = 1, most = 0;
  for (int k = 0; k < kSize * kSize; ++k) {
    const SurfacePoint &upper = view.points[k], &lower = view.points[k + kSize * kSize];
    EXPECT_EQ(upper.normal, lower.normal);
    EXPECT_LT(std::abs(Dot(upper.x, lower.x)), 0.75);  // folds shear the threads
    along += Dot(upper.x, lights[0].direction) / (kSize * kSize);
    across += std::abs(Dot(lower.x, lights[0].direction)) / (kSize * kSize);
    least = std::min(least, Dot(upper.normal, kEye));
    most = std::max(most, Dot(upper.normal, kEye));
  }
  EXPECT_GT(along, 0.7);
  EXPECT_LT(across, 0.4);
  EXPECT_LT(least, 0.7);  // folded
  EXPECT_GT(most, 0.95);
}

TEST(Render, AgreesWithTheWayOfIsotropicSpheres) {
  const BrdfTable plastic = Synthesize(FindSynthMaterial("plastic"), 0, 1, {30, 30, 60});
  const TabulatedBrdf table(plastic);
  const std::vector<Light> lights = TestLights();
  const AngularBrdf angular[] = {Interpolated(table)};
  const SphericalBrdf spherical[] = {Isotropic(angular[0]).spherical};
  const RenderedImage fast =
      RenderSpheres(
          angular, lights, 24,
          [](const HalfDiffAngles&, const Cosines& c) { return std::min(c.i, c.o) >= std::cos(1); },
          1)
          .at(0);
  const RenderedImage image =
      Render(ViewSphere(24), spherical, lights, Steep, false, 1).counted.at(0);
  for (size_t k = 0; k < image.radiance.size(); ++k) {
    EXPECT_NEAR(image.coverage[k], fast.coverage[k], 1e-12);
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(image.radiance[k][c], fast.radiance[k][c], 1e-6 * fast.radiance[k][c] + 1e-12);
    }
  }
}

// Pixel by pixel, by directions in the frame of each point, of a metal brushed along x.
TEST(Render, SeesAnAnisotropicMaterialInItsFrame) {
  const BrdfFunction& steel = FindSynthMaterial("aniso_ggx_steel").brdf;
  const SphericalBrdf brdfs[] = {
      [&](const SphericalAngles& at) { return steel(ToDirections(at)); }};
  const std::vector<Light> lights = TestLights();
  for (const View& view : {ViewSphere(16), ViewCloth(9, lights)}) {
    const RenderedImages images = Render(view, brdfs, lights, Steep, true, 2);
    for (const SurfacePoint& point : view.points) {
      const auto local = [&](const Direction& d) {
        return Direction{Dot(d, point.x), Dot(d, point.y), Dot(d, point.normal)};
      };
      Rgb all{}, counted{};
      for (const Light& light : lights) {
        const DirectionPair pair = {local(light.direction), local(kEye)};
        if (!(pair.wi[2] > 0)) continue;
        const Rgb rho = steel(pair);
        const bool counts = std::min(pair.wi[2], pair.wo[2]) >= std::cos(1);
        for (int c = 0; c < kChannels; ++c) {
          const double radiance = rho[c] * pair.wi[2] * light.irradiance[c];
          all[c] += radiance;
          if (counts) counted[c] += radiance;
        }
      }
      for (int c = 0; c < kChannels; ++c) {
        EXPECT_NEAR(images.whole[0].radiance[point.pixel][c], all[c], 1e-9 * all[c]);
        EXPECT_NEAR(images.counted[0].radiance[point.pixel][c], counted[c], 1e-9 * all[c]);
      }
    }
  }
}

TEST(Render, IsTheSameForAnyNumberOfThreads) {
  const BrdfFunction& steel = FindSynthMaterial("aniso_ggx_steel").brdf;
  const SphericalBrdf brdfs[] = {
      [&](const SphericalAngles& at) { return steel(ToDirections(at)); }};
  const std::vector<Light> lights = TestLights();
  const View view = ViewSphere(40);
  const RenderedImages one = Render(view, brdfs, lights, Everything, true, 1);
  const RenderedImages three = Render(view, brdfs, lights, Everything, true, 3);
  EXPECT_EQ(one.counted[0].radiance, three.counted[0].radiance);
  EXPECT_EQ(one.whole[0].radiance, one.counted[0].radiance);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
