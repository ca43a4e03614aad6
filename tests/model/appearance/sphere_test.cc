#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "tests/test_util.h"
#include "trilobe/model/appearance/render.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid = {.theta_h = 10, .theta_d = 12, .phi_d = 16};
constexpr int kSize = 24;

using Counts = std::function<bool(const HalfDiffAngles&, const Cosines&)>;

bool Everything(const HalfDiffAngles& /*angles*/, const Cosines& /*cosines*/) { return true; }

double Dot(const Direction& a, const Direction& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Direction Normalized(const Direction& v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

Direction Cross(const Direction& a, const Direction& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Lights from all sides, from the eye itself, and from behind.
std::vector<Light> TestLights() {
  Random random(3);
  std::vector<Light> lights = {{{0, 0, 1}, {1, 2, 3}},
                               {{0, 0, -1}, {1, 1, 1}},
                               {{1, 0, 0}, {2, 1, 1}},
                               {{0, -1, 0}, {1, 2, 1}}};
  for (int k = 0; k < 40; ++k) {
    lights.push_back({Normalized({random.Normal(), random.Normal(), random.Normal()}),
                      {random.LogNormal(1), random.LogNormal(1), random.LogNormal(1)}});
  }
  return lights;
}

// Light from the eye has no phi_d, on which a table of random numbers depends all the same.
std::vector<Light> NotFromTheEye() {
  std::vector<Light> lights = TestLights();
  lights.erase(lights.begin());
  return lights;
}

BrdfTable MirroredTable(const BrdfTable& table) {
  BrdfTable mirrored = table;
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    const int p = bin % table.grid.phi_d;
    const int mirror = bin - p + table.grid.phi_d - 1 - p;
    for (int c = 0; c < kChannels; ++c) mirrored.stored[c][bin] = table.stored[c][mirror];
  }
  return mirrored;
}

// Pixel by pixel and light by light, by the directions themselves in a frame on the surface.
struct Reference {
  std::vector<Rgb> radiance;
  std::vector<double> coverage;
};
Reference RenderReference(const std::function<Rgb(const DirectionPair&)>& brdf,
                          const std::vector<Light>& lights, int size, const Counts& counts) {
  Reference image{std::vector<Rgb>(size * size), std::vector<double>(size * size, -1.0)};
  for (int index = 0; index < size * size; ++index) {
    const int row = index / size;
    const double x = (index % size + 0.5) / size * 2 - 1;
    const double y = 1 - (row + 0.5) / size * 2;
    if (!(x * x + y * y < 1)) continue;
    const Direction n = {x, y, std::sqrt(1 - x * x - y * y)};
    const Direction t = Normalized(Cross({0.3, 0.9, -0.2}, n)), b = Cross(n, t);
    const auto local = [&](const Direction& d) {
      return Direction{Dot(d, t), Dot(d, b), Dot(d, n)};
    };
    double light_sum = 0, counted = 0;
    for (const Light& light : lights) {
      const DirectionPair pair = {local(light.direction), local({0, 0, 1})};
      if (!(pair.wi[2] > 0)) continue;
      light_sum += pair.wi[2];
      const HalfDiffAngles angles = ToHalfDiff(pair);
      if (!counts(angles, {pair.wi[2], pair.wo[2]})) continue;
      counted += pair.wi[2];
      const Rgb rho = brdf(pair);
      for (int c = 0; c < kChannels; ++c) {
        image.radiance[index][c] += rho[c] * pair.wi[2] * light.irradiance[c];
      }
    }
    image.coverage[index] = light_sum > 0 ? counted / light_sum : 1;
  }
  return image;
}

double LargestDifference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double largest = 0;
  for (size_t k = 0; k < a.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) {
      largest = std::max(largest, std::abs(a[k][c] - b[k][c]) / std::max(std::abs(b[k][c]), 1e-9));
    }
  }
  return largest;
}

TEST(SphereTest, ALambertianSphereIsWhatLambertSays) {
  const Rgb albedo = {0.1, 0.2, 0.3};
  const AngularBrdf materials[] = {
      [&](const HalfDiffAngles& /*angles*/, const Cosines& /*cosines*/) { return albedo; }};
  const Direction l = Normalized({1, 2, 2});
  const Light lights[] = {{l, {5, 6, 7}}};
  const RenderedImage image = RenderSpheres(materials, lights, kSize, Everything, 1).at(0);
  ASSERT_EQ(image.size, kSize);
  int lit = 0;
  for (int k = 0; k < kSize * kSize; ++k) {
    const int row = k / kSize;
    const double x = (k % kSize + 0.5) / kSize * 2 - 1, y = 1 - (row + 0.5) / kSize * 2;
    const double r2 = x * x + y * y;
    if (r2 >= 1) {
      EXPECT_LT(image.coverage[k], 0);
      EXPECT_EQ(image.radiance[k], Rgb{});
      continue;
    }
    EXPECT_EQ(image.coverage[k], 1);
    const double cosine = std::max(0.0, (x + 2 * y + 2 * std::sqrt(1 - r2)) / 3);
    lit += cosine > 0;
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(image.radiance[k][c], albedo[c] * lights[0].irradiance[c] * cosine, 1e-13);
    }
  }
  EXPECT_GT(lit, kSize * kSize / 2);
}

// A table without any symmetry: one that is turned the wrong way shows it.
TEST(SphereTest, EqualsTheReferenceSum) {
  const BrdfTable table = RandomTable(kGrid, 1, 0.1);
  const BrdfTable mirrored = MirroredTable(table);
  const TabulatedBrdf brdf(table), other(mirrored);
  const std::vector<Light> lights = NotFromTheEye();
  const AngularBrdf materials[] = {Interpolated(brdf), Interpolated(other)};
  const std::vector<RenderedImage> images = RenderSpheres(materials, lights, kSize, Everything, 1);
  const auto reference = [&](const TabulatedBrdf& brdf) {
    return RenderReference([&](const DirectionPair& pair) { return brdf.Interpolate(pair); },
                           lights, kSize, Everything)
        .radiance;
  };
  EXPECT_LT(LargestDifference(images[0].radiance, reference(brdf)), 1e-6);
  EXPECT_LT(LargestDifference(images[1].radiance, reference(other)), 1e-6);
  EXPECT_GT(LargestDifference(images[0].radiance, images[1].radiance), 0.1);
}

// Every angle of every pair, not only what a table makes of them.
TEST(SphereTest, HandsOverTheAnglesOfTheDirections) {
  const std::vector<Light> lights = TestLights();
  const auto wave = [](const HalfDiffAngles& a, const Cosines& cosines) {
    // Periodic in phi_d, and the same for all of them where they have no meaning.
    const double odd = std::sin(a.theta_h) * std::sin(a.theta_d);
    return Rgb{2 + odd * std::sin(2 * a.phi_d), 2 + odd * std::cos(2 * a.phi_d),
               cosines.i + 2 * cosines.o + a.theta_h + 3 * a.theta_d};
  };
  const AngularBrdf materials[] = {wave};
  const RenderedImage image = RenderSpheres(materials, lights, kSize, Everything, 1).at(0);
  const Reference expected = RenderReference(
      [&](const DirectionPair& pair) {
        return wave(ToHalfDiff(pair), {pair.wi[2], pair.wo[2]});
      },
      lights, kSize, Everything);
  EXPECT_LT(LargestDifference(image.radiance, expected.radiance), 1e-7);
}

TEST(SphereTest, LeavesOutWhatDoesNotCount) {
  const BrdfTable table = RandomTable(kGrid, 2, 0);
  const TabulatedBrdf brdf(table);
  const std::vector<Light> lights = NotFromTheEye();
  const Counts counts = [](const HalfDiffAngles& angles, const Cosines& cosines) {
    return angles.theta_d < 0.7 && cosines.i > 0.3 && cosines.o > 0.2;
  };
  const AngularBrdf materials[] = {Interpolated(brdf)};
  const RenderedImage image = RenderSpheres(materials, lights, kSize, counts, 1).at(0);
  const Reference expected = RenderReference(
      [&](const DirectionPair& pair) { return brdf.Interpolate(pair); }, lights, kSize, counts);
  EXPECT_LT(LargestDifference(image.radiance, expected.radiance), 1e-6);
  for (size_t k = 0; k < image.coverage.size(); ++k) {
    EXPECT_NEAR(image.coverage[k], expected.coverage[k], 1e-12);
  }
  EXPECT_LT(std::ranges::count_if(image.coverage, [](double x) { return x == 1; }), kSize);
}

TEST(SphereTest, WithoutMaterialsOrLightsThereIsNothingToSee) {
  EXPECT_TRUE(RenderSpheres({}, TestLights(), kSize, Everything, 2).empty());
  const AngularBrdf materials[] = {
      [](const HalfDiffAngles& /*angles*/, const Cosines& /*cosines*/) {
        return Rgb{1, 1, 1};
      }};
  const RenderedImage image = RenderSpheres(materials, {}, kSize, Everything, 2).at(0);
  EXPECT_TRUE(std::ranges::all_of(image.radiance, [](const Rgb& x) { return x == Rgb{}; }));
}

// One pixel in four is rendered, in all parts of the sphere, with the value it has among all.
TEST(SphereTest, FewerPixelsAreSomeOfAll) {
  const BrdfTable table = RandomTable(kGrid, 4);
  const TabulatedBrdf brdf(table);
  const std::vector<Light> lights = TestLights();
  const AngularBrdf materials[] = {Interpolated(brdf)};
  constexpr int kWide = 36;
  const RenderedImage all = RenderSpheres(materials, lights, kWide, Everything, 1).at(0);
  const RenderedImage some = RenderSpheres(materials, lights, kWide, Everything, 1, 4).at(0);
  int quarters[4] = {}, of_all[4] = {};
  for (int k = 0; k < kWide * kWide; ++k) {
    const int quarter = k / kWide / (kWide / 2) * 2 + k % kWide / (kWide / 2);
    if (all.coverage[k] >= 0) ++of_all[quarter];
    if (some.coverage[k] < 0) continue;
    ++quarters[quarter];
    EXPECT_EQ(some.radiance[k], all.radiance[k]) << k;
    EXPECT_EQ(some.coverage[k], all.coverage[k]) << k;
  }
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(quarters[k], of_all[k] / 4.0, 5) << k;
}

TEST(SphereTest, IsTheSameForAnyNumberOfThreads) {
  const BrdfTable table = RandomTable(kGrid, 4);
  const TabulatedBrdf brdf(table);
  const std::vector<Light> lights = TestLights();
  const AngularBrdf materials[] = {Interpolated(brdf)};
  const RenderedImage one = RenderSpheres(materials, lights, 37, Everything, 1).at(0);
  for (const int threads : {2, 3}) {
    const RenderedImage many = RenderSpheres(materials, lights, 37, Everything, threads).at(0);
    EXPECT_EQ(many.radiance, one.radiance) << threads;
    EXPECT_EQ(many.coverage, one.coverage) << threads;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
