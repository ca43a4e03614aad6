// Invalid arguments give an Error of one line, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/test_directory.h"
#include "tests/test_util.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/render.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 8};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const AngularBrdf kGrey = [](const HalfDiffAngles&, const Cosines&) { return Rgb{1, 1, 1}; };
const SphericalBrdf kGreyOfAny = [](const SphericalAngles&) { return Rgb{1, 1, 1}; };

TEST(Arguments, Environments) {
  EXPECT_THAT(ErrorOf([] { DrawLights({"none", 0, 0, {}}, 4); }), HasSubstr("none: "));
  EXPECT_THAT(ErrorOf([] {
                DrawLights({"short", 2, 2, {Rgb{1, 1, 1}}}, 4);
              }),
              HasSubstr("short: "));
  EXPECT_THAT(ErrorOf([] { DrawLights({"odd", -1, -1, {Rgb{1, 1, 1}}}, 4); }), HasSubstr("odd: "));
  for (const double bad : {-1.0, kNaN}) {
    EXPECT_THAT(ErrorOf([&] {
                  DrawLights({"bad", 1, 1, {Rgb{1, bad, 1}}}, 4);
                }),
                HasSubstr("radiance of a pixel"));
  }
  for (const int count : {0, -1}) {
    EXPECT_THAT(ErrorOf([&] { DrawLights(StudioEnvironment(), count); }), HasSubstr("lights"));
  }
}

TEST(Arguments, OfAppearance) {
  const BrdfTable table = RandomTable(kGrid, 1);
  const NodeBrdf nodes({"nodes", {1, 2}, std::vector<Rgb>(4), std::vector<bool>(4, true)});
  const auto compare = [&](const AppearanceOptions& options) {
    const std::string error = ErrorOf([&] { CompareAppearance(table, kGrey, options); });
    EXPECT_EQ(ErrorOf([&] { SphereJudge(table, options)(kGrey); }), error);
    EXPECT_EQ(ErrorOf([&] { CompareAppearance(nodes, kGreyOfAny, options); }), error);
    EXPECT_EQ(ErrorOf([&] { RenderMeasuredPair(table, kGrey, options); }), error);
    return error;
  };
  EXPECT_THAT(compare({.lights = 0}), HasSubstr("lights"));
  EXPECT_THAT(compare({.lights = 1, .size = 0}), HasSubstr("size of a picture"));
  EXPECT_THAT(compare({.lights = 1, .size = 1 << 20}), HasSubstr("size of a picture"));
  EXPECT_THAT(compare({.lights = 1, .size = 8, .num_threads = -1}), HasSubstr("num_threads"));
  const Environment none;
  EXPECT_THAT(compare({.environment = &none}), HasSubstr("0 x 0 pixels"));
}

TEST(Arguments, EmptyFunctions) {
  const BrdfTable table = RandomTable(kGrid, 1);
  const NodeBrdf nodes({"nodes", {1, 2}, std::vector<Rgb>(4), std::vector<bool>(4, true)});
  const AppearanceOptions options = {.lights = 1, .size = 8};
  const auto empty = HasSubstr("not empty");
  EXPECT_THAT(ErrorOf([&] { CompareAppearance(table, nullptr, options); }), empty);
  EXPECT_THAT(ErrorOf([&] { CompareAppearance(nodes, nullptr, options); }), empty);
  EXPECT_THAT(ErrorOf([&] { RenderPicture(table, nullptr, options); }), empty);
  EXPECT_THAT(ErrorOf([&] { RenderPicture(Material{}, options); }), empty);
  EXPECT_THAT(ErrorOf([] { Isotropic(nullptr); }), empty);
  const std::vector<Light> lights = DrawLights(StudioEnvironment(), 1);
  EXPECT_THAT(ErrorOf([&] { RenderSpheres({&kGrey, 1}, lights, 8, nullptr, 1); }), empty);
  EXPECT_THAT(ErrorOf([&] {
                Render(ViewSphere(8), {&kGreyOfAny, 1}, lights, nullptr, false, 1);
              }),
              empty);
  EXPECT_THAT(ErrorOf([&] { CompareAlbedos(nullptr, nullptr, {}, 1); }), empty);
}

TEST(Arguments, PicturesOfOtherSizes) {
  const RenderedImage small{1, {Rgb{}}, {1.0}}, large{2, std::vector<Rgb>(4), {1, 1, 1, 1}};
  EXPECT_NE(ErrorOf([&] { CompareSpheres(small, large); }), "");
  EXPECT_NE(ErrorOf([&] { CompareSpheres(large, small); }), "");
  EXPECT_NE(ErrorOf([] { ViewSphere(8, 0); }), "");
  const View view{2, 2, {SurfacePoint{.pixel = 4}}};
  EXPECT_THAT(ErrorOf([&] {
                Render(
                    view, {&kGreyOfAny, 1}, {}, [](const SphericalAngles&) { return true; }, false,
                    1);
              }),
              HasSubstr("pixel"));
  const NodeBrdf nodes({"nodes", {1, 2}, std::vector<Rgb>(4), std::vector<bool>(4, true)});
  EXPECT_NE(ErrorOf([&] { nodes({kNaN, 0, 0, 0}); }), "");
  EXPECT_NE(ErrorOf([&] { nodes({0, kNaN, 0, 0}); }), "");
  EXPECT_NE(ErrorOf([&] { nodes.MeasuredAround(0, 2); }), "");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
