#include "trilobe/model/measurement/hemisphere_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/error_of.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(HemisphereGrid, FindsItsOwnNodes) {
  for (const HemisphereGrid& grid :
       {HemisphereGrid(), HemisphereGrid{1, 1}, HemisphereGrid{7, 13}}) {
    for (int node = 0; node < grid.nodes(); ++node) {
      const double theta = grid.Theta(node), phi = grid.Phi(node);
      EXPECT_EQ(grid.Find(theta, phi), node);
      EXPECT_EQ(grid.Find(theta + 1e-7, phi - 2 * kPi - 1e-7), node);
      EXPECT_EQ(grid.Find(theta + 1e-3, phi), std::nullopt);
      EXPECT_EQ(grid.Find(theta, phi + 1e-3), std::nullopt);
    }
    EXPECT_EQ(grid.Find(kPi / 2, 0), std::nullopt);
  }
}

TEST(HemisphereGrid, IsParsed) {
  EXPECT_EQ(ParseHemisphereGrid("6x48"), HemisphereGrid());
  EXPECT_EQ(ParseHemisphereGrid("1x3162"), (HemisphereGrid{1, 3162}));
  for (const char* text : {"", "x", "6", "6x", "x48", "6x48x3", "0x48", "-6x-48", "6.5x4", "60x60",
                           "99999x99999", "99999999999x1"}) {
    EXPECT_THAT(ErrorOf([&] { ParseHemisphereGrid(text); }),
                IsError(ErrorKind::kFormat, {.key = "grid of directions", .value = text}))
        << text;
  }
}

TEST(AtNodes, InterpolatesATableWhereItHasValues) {
  Measurement foam = LoadMeasurement("synth:foam");
  const TabulatedBrdf brdf(*foam.table);
  const HemisphereGrid grid{4, 6};
  const Measurement at_nodes = AtNodes(foam, grid, 2);
  EXPECT_TRUE(at_nodes.anisotropic);
  ASSERT_EQ(at_nodes.counts.valid, 24 * 24);
  const SphericalAngles at = grid.Angles(9, 20);
  EXPECT_EQ(at_nodes.samples.rho[9 * 24 + 20], brdf.Interpolate(ToDirections(at)));
  LimitAngles(DegreesToRadians(50), &foam);
  const Measurement part = AtNodes(foam, grid, 1);  // theta = 0, 22.5, 45, but not 67.5
  EXPECT_EQ(part.counts.valid, 18 * 18);
  EXPECT_EQ(part.counts.missing, 24 * 24 - 18 * 18);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
