#include "model/appearance/render_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/appearance/color.h"
#include "model/appearance/mirrored_environment.h"
#include "trilobe/model/appearance/render.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

bool Everything(const HalfDiffAngles& /*angles*/, const Cosines& /*cosines*/) { return true; }

Environment Uniform() { return {"uniform", 8, 4, std::vector<Rgb>(32, Rgb{1, 1, 1})}; }

RenderedImage Under(const Environment& environment, const AngularBrdf& brdf, int size = 32,
                    int num_threads = 1) {
  return RenderSphereUnder(environment, size, {&brdf, 1}, Everything, num_threads).whole[0];
}

Rgb White(const HalfDiffAngles& /*angles*/, const Cosines& /*cosines*/) {
  return {1 / kPi, 1 / kPi, 1 / kPi};
}

// A mirror, blurred by so many degrees of theta_h, that reflects about all.
AngularBrdf Gloss(double degrees) {
  const double width = DegreesToRadians(degrees);
  return [width](const HalfDiffAngles& angles, const Cosines& cosines) {
    const double x = angles.theta_h / width;
    const double d = std::exp(-x * x) / (kPi * width * width);
    const double rho = d / (4 * std::cos(angles.theta_d) * std::max(cosines.i, 0.05));
    return Rgb{rho, rho, rho};
  };
}

// The middle of the sphere, where no half vector of light is below the horizon.
template <typename Check>
void ForMiddlePixels(const RenderedImage& image, double radius, const Check& check) {
  for (int k = 0; k < image.size * image.size; ++k) {
    const int row = k / image.size;
    const double x = (k % image.size + 0.5) / image.size * 2 - 1;
    const double y = 1 - (row + 0.5) / image.size * 2;
    if (std::hypot(x, y) < radius) check(x, y, image.radiance[k]);
  }
}

TEST(HalfCells, CoverTheHemisphere) {
  double sum = 0;
  for (const HalfCell& cell : HalfCells()) {
    sum += cell.solid_angle;
    EXPECT_NEAR(Dot(cell.half, cell.half), 1, 1e-12);
  }
  EXPECT_NEAR(sum, 2 * kPi, 1e-9);
}

TEST(RenderSphereUnder, IsWhiteWhereAllIsWhite) {
  const RenderedImage image = Under(Uniform(), White);
  ForMiddlePixels(image, 1, [](double, double, const Rgb& seen) { EXPECT_NEAR(seen[0], 1, 0.05); });
}

// No dots, whatever the gloss: a mirror under an even sky is even.
TEST(RenderSphereUnder, IsSmoothForAnyGloss) {
  for (const double degrees : {0.3, 1.0, 5.0}) {
    const RenderedImage image = Under(Uniform(), Gloss(degrees));
    ForMiddlePixels(image, 0.9, [&](double, double, const Rgb& seen) {
      EXPECT_NEAR(seen[1], 1, 0.12) << degrees;
    });
  }
}

TEST(RenderSphereUnder, ShowsTheEnvironmentInAMirror) {
  const RenderedImage image = Under(StudioEnvironment(), Gloss(0.3), 40);
  const MirroredEnvironment mirrored(StudioEnvironment());
  int far = 0, pixels = 0;
  ForMiddlePixels(image, 0.8, [&](double x, double y, const Rgb& seen) {
    const Direction normal = {x, y, std::sqrt(1 - x * x - y * y)};
    ++pixels;
    far += std::abs(Luminance(seen) / Luminance(mirrored.Mean(normal, 1e-4)) - 1) > 0.2;
  });
  EXPECT_LT(far, 0.1 * pixels);  // the edges of lamps
}

// Many points show the same of a rough material, but for light that a wide cell carries over the
// horizon, into the dark half below.
TEST(RenderSphereUnder, AgreesWithManyPoints) {
  const AngularBrdf brdf = [](const HalfDiffAngles& angles, const Cosines&) {
    const double c = std::cos(angles.theta_h);
    return Rgb{0.1 + c * c * c * c, 0.2, 0.3};
  };
  const RenderedImage image = Under(StudioEnvironment(), brdf, 24);
  const std::vector<Light> lights = DrawLights(StudioEnvironment(), 4000);
  const RenderedImage points =
      RenderSpheres({&brdf, 1}, lights, 24, Everything, /*num_threads=*/1)[0];
  double error = 0, sum = 0;
  for (size_t k = 0; k < points.radiance.size(); ++k) {
    error += std::abs(image.radiance[k][0] - points.radiance[k][0]);
    sum += points.radiance[k][0];
  }
  EXPECT_LT(error, 0.06 * sum);
}

// Rendering a quarter of the pixels and turning it gives each pixel its own value: with a pixel in
// the middle (odd sizes), which turns map to itself, or without, and for materials that differ on
// the two sides of the plane of light and eye.
TEST(RenderSphereUnder, AgreesWithEachPixelByItself) {
  const AngularBrdf brdf = [](const HalfDiffAngles& angles, const Cosines& cosines) {
    const Rgb gloss = Gloss(5)(angles, cosines);
    return Rgb{gloss[0], 0.1 + angles.phi_d, 0.2 + angles.theta_d};
  };
  const auto counts = [](const HalfDiffAngles& angles, const Cosines&) {
    return angles.theta_d < 0.7 && angles.theta_h < 0.9;
  };
  for (const int size : {24, 25}) {
    const AngularBrdf brdfs[] = {White, brdf};
    const RenderedImages images = RenderSphereUnder(StudioEnvironment(), size, brdfs, counts, 2);
    const SphericalBrdf sphericals[] = {Isotropic(White).spherical, Isotropic(brdf).spherical};
    const RenderedImages each = RenderUnder(
        StudioEnvironment(), ViewSphere(size), sphericals,
        [&](const SphericalAngles& at) { return counts(ToHalfDiff(ToDirections(at)), {}); }, 2);
    for (const int m : {0, 1}) {
      int partly = 0;
      for (size_t k = 0; k < each.whole[m].radiance.size(); ++k) {
        for (int c = 0; c < kChannels; ++c) {
          const double whole = each.whole[m].radiance[k][c];
          EXPECT_NEAR(images.whole[m].radiance[k][c], whole, 1e-5 * whole) << k;
          EXPECT_NEAR(images.counted[m].radiance[k][c], each.counted[m].radiance[k][c],
                      1e-5 * whole)
              << k;
        }
        const double coverage = each.whole[m].coverage[k];
        EXPECT_NEAR(images.whole[m].coverage[k], coverage, 1e-9) << k;
        EXPECT_EQ(images.counted[m].coverage[k], images.whole[m].coverage[k]);
        partly += coverage > 0.01 && coverage < 0.99;
      }
      EXPECT_GT(partly, size * size / 2);
    }
  }
}

TEST(RenderSphereUnder, IsTheSameForAnyNumberOfThreads) {
  const RenderedImage one = Under(StudioEnvironment(), Gloss(1), 24, 1);
  EXPECT_EQ(Under(StudioEnvironment(), Gloss(1), 24, 3).radiance, one.radiance);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
