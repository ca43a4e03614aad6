// Invalid arguments give an Error of one line, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/render.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 8};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const AngularBrdf kGrey = [](const HalfDiffAngles&, const Cosines&) { return Rgb{1, 1, 1}; };
const SphericalBrdf kGreyOfAny = [](const SphericalAngles&) { return Rgb{1, 1, 1}; };

TEST(Arguments, Environments) {
  EXPECT_THAT(ErrorOf([] {
                DrawLights({"none", 0, 0, {}}, 4);
              }),
              IsError(ErrorKind::kMismatch, {.file = "none", .key = "radiance", .value = "0"}));
  EXPECT_THAT(ErrorOf([] {
                DrawLights({"short", 2, 2, {Rgb{1, 1, 1}}}, 4);
              }),
              IsError(ErrorKind::kMismatch, {.file = "short", .key = "radiance", .value = "1"}));
  EXPECT_THAT(ErrorOf([] {
                DrawLights({"odd", -1, -1, {Rgb{1, 1, 1}}}, 4);
              }),
              IsError(ErrorKind::kMismatch, {.file = "odd", .key = "radiance", .value = "1"}));
  for (const double bad : {-1.0, kNaN}) {
    EXPECT_THAT(ErrorOf([&] {
                  DrawLights({"bad", 1, 1, {Rgb{1, bad, 1}}}, 4);
                }),
                IsError(ErrorKind::kRange, {.key = "radiance"}));
  }
  for (const int count : {0, -1}) {
    EXPECT_THAT(ErrorOf([&] { DrawLights(StudioEnvironment(), count); }),
                IsError(ErrorKind::kRange, {.key = "the number of lights"}));
  }
}

TEST(Arguments, OfAppearance) {
  const BrdfTable table = RandomTable(kGrid, 1);
  const NodeBrdf nodes({"nodes", {1, 2}, std::vector<Rgb>(4), std::vector<bool>(4, true)});
  const auto compare = [&](const AppearanceOptions& options) {
    const auto error = ErrorOf([&] { CompareAppearance(table, kGrey, options); });
    EXPECT_STREQ(ErrorOf([&] { SphereJudge(table, options)(kGrey); })->what(), error->what());
    EXPECT_STREQ(ErrorOf([&] { CompareAppearance(nodes, kGreyOfAny, options); })->what(),
                 error->what());
    EXPECT_STREQ(ErrorOf([&] { RenderMeasuredPair(table, kGrey, options); })->what(),
                 error->what());
    return error;
  };
  EXPECT_THAT(compare({.lights = 0}),
              IsError(ErrorKind::kRange, {.key = "the number of lights", .value = "0"}));
  EXPECT_THAT(compare({.lights = 1, .size = 0}),
              IsError(ErrorKind::kRange, {.key = "the size of a picture", .value = "0"}));
  EXPECT_THAT(compare({.lights = 1, .size = 1 << 20}),
              IsError(ErrorKind::kRange, {.key = "the size of a picture", .value = "1048576"}));
  EXPECT_THAT(compare({.lights = 1, .size = 8, .num_threads = -1}),
              IsError(ErrorKind::kRange, {.key = "num_threads", .value = "-1"}));
  const Environment none;
  EXPECT_THAT(compare({.environment = &none}),
              IsError(ErrorKind::kMismatch, {.key = "radiance", .value = "0"}));
}

TEST(Arguments, EmptyFunctions) {
  const BrdfTable table = RandomTable(kGrid, 1);
  const NodeBrdf nodes({"nodes", {1, 2}, std::vector<Rgb>(4), std::vector<bool>(4, true)});
  const AppearanceOptions options = {.lights = 1, .size = 8};
  EXPECT_THAT(ErrorOf([&] { CompareAppearance(table, nullptr, options); }),
              IsError(ErrorKind::kMissing, {.key = "the material"}));
  EXPECT_THAT(ErrorOf([&] { CompareAppearance(nodes, nullptr, options); }),
              IsError(ErrorKind::kMissing, {.key = "the material"}));
  EXPECT_THAT(ErrorOf([&] { RenderPicture(table, nullptr, options); }),
              IsError(ErrorKind::kMissing, {.key = "the material"}));
  EXPECT_THAT(ErrorOf([&] { RenderPicture(Material{}, options); }),
              IsError(ErrorKind::kMissing, {.key = "the material"}));
  EXPECT_THAT(ErrorOf([] { Isotropic(nullptr); }), IsError(ErrorKind::kMissing, {.key = "brdf"}));
  const std::vector<Light> lights = DrawLights(StudioEnvironment(), 1);
  EXPECT_THAT(ErrorOf([&] {
                RenderSpheres({&kGrey, 1}, lights, 8, nullptr, 1);
              }),
              IsError(ErrorKind::kMissing, {.key = "counts"}));
  EXPECT_THAT(ErrorOf([&] {
                Render(ViewSphere(8), {&kGreyOfAny, 1}, lights, nullptr, false, 1);
              }),
              IsError(ErrorKind::kMissing, {.key = "counts"}));
  EXPECT_THAT(ErrorOf([&] { CompareAlbedos(nullptr, nullptr, {}, 1); }),
              IsError(ErrorKind::kMissing, {.key = "measured"}));
}

TEST(Arguments, PicturesOfOtherSizes) {
  const RenderedImage small{1, {Rgb{}}, {1.0}}, large{2, std::vector<Rgb>(4), {1, 1, 1, 1}};
  EXPECT_THAT(ErrorOf([&] { CompareSpheres(small, large); }),
              IsError(ErrorKind::kMismatch, {.key = "a picture", .value = "4"}));
  EXPECT_THAT(ErrorOf([&] { CompareSpheres(large, small); }),
              IsError(ErrorKind::kMismatch, {.key = "a picture", .value = "1"}));
  EXPECT_THAT(ErrorOf([] { ViewSphere(8, 0); }),
              IsError(ErrorKind::kRange, {.key = "every", .value = "0"}));
  const View view{2, 2, {SurfacePoint{.pixel = 4}}};
  EXPECT_THAT(ErrorOf([&] {
                Render(
                    view, {&kGreyOfAny, 1}, {}, [](const SphericalAngles&) { return true; }, false,
                    1);
              }),
              IsError(ErrorKind::kRange, {.key = "the pixel of a point", .value = "4"}));
  const NodeBrdf nodes({"nodes", {1, 2}, std::vector<Rgb>(4), std::vector<bool>(4, true)});
  EXPECT_THAT(ErrorOf([&] {
                nodes({kNaN, 0, 0, 0});
              }),
              IsError(ErrorKind::kRange, {.key = "theta", .value = "nan"}));
  EXPECT_THAT(ErrorOf([&] {
                nodes({0, kNaN, 0, 0});
              }),
              IsError(ErrorKind::kRange, {.key = "radians", .value = "nan"}));
  EXPECT_THAT(ErrorOf([&] { nodes.MeasuredAround(0, 2); }),
              IsError(ErrorKind::kRange, {.key = "the node", .value = "2"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
