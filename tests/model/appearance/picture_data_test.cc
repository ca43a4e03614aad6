#include "model/appearance/picture_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "model/appearance/node_appearance.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

Measurement Velvet(const SourceOptions& options = {}) {
  return LoadMeasurement("synth:velvet@5x16", options);
}

TEST(GridOf, FindsTheGridThatSamplesStandOn) {
  EXPECT_EQ(GridOf(Velvet()), (HemisphereGrid{5, 16}));
  EXPECT_EQ(GridOf(Velvet({.noise = 0.1, .missing = 0.3})), (HemisphereGrid{5, 16}));
  EXPECT_EQ(GridOf(Velvet({.max_angle_deg = 40})), (HemisphereGrid{5, 16}));
  Measurement turned = Velvet();
  for (SphericalAngles& at : turned.samples.directions) at.phi_i -= 4 * kPi;
  EXPECT_EQ(GridOf(turned), (HemisphereGrid{5, 16}));
}

TEST(GridOf, FindsNoneWhereSamplesStandAnyhow) {
  EXPECT_EQ(GridOf(Velvet({.missing = 0.7})), std::nullopt);  // too few
  Measurement off = Velvet();
  off.samples.directions[100].phi_o += 1e-3;
  EXPECT_EQ(GridOf(off), std::nullopt);
  Measurement twice = Velvet();
  twice.samples.directions[100] = twice.samples.directions[101];
  EXPECT_EQ(GridOf(twice), std::nullopt);
  Measurement isotropic = Velvet();
  isotropic.anisotropic = false;  // azimuths are given, though they do not matter
  EXPECT_EQ(GridOf(isotropic), GridOf(Velvet()));
  std::erase_if(isotropic.samples.directions, [](const auto& at) { return at.phi_i > 0; });
  isotropic.samples.angles.resize(isotropic.samples.directions.size());
  isotropic.samples.rho.resize(isotropic.samples.directions.size());
  EXPECT_EQ(GridOf(isotropic), std::nullopt);
  EXPECT_EQ(GridOf(Velvet({.max_angle_deg = 10})), std::nullopt);  // the normal alone
}

TEST(PictureDataOf, HasTheValuesOfTheSamples) {
  const Measurement velvet = Velvet({.noise = 0.2, .missing = 0.1});
  const PictureData pictured = PictureDataOf(velvet);
  ASSERT_TRUE(pictured.nodes);
  EXPECT_EQ(pictured.table, nullptr);
  for (int j = 0; j < velvet.samples.size(); j += 17) {
    const SphericalAngles& at = velvet.samples.directions[j];
    EXPECT_TRUE(pictured.nodes->Measured(at));
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR((*pictured.nodes)(at)[c], velvet.samples.rho[j][c], 1e-12);
    }
  }
  EXPECT_EQ(std::ranges::count(pictured.nodes->table().present, true), velvet.samples.size());
  const Measurement plastic = LoadMeasurement("synth:plastic");
  EXPECT_EQ(PictureDataOf(plastic).table, &*plastic.table);
}

TEST(PictureData, HasNoPictureOfSamplesOnNoGridNorOfAzimuthsInATable) {
  Measurement off = Velvet();
  off.samples.directions[100].phi_o += 1e-3;
  const FactorModel aniso(ModelSpec::Anisotropic(1)), iso(ModelSpec::SharedFactors(1));
  const PictureData none = PictureDataOf(off);
  EXPECT_TRUE(none.empty());
  EXPECT_THAT(ErrorOf([&] { CompareAppearance(none, MaterialOf(iso), {}); }),
              IsError(ErrorKind::kUnsupported, {.key = "grid"}));
  const Measurement plastic = LoadMeasurement("synth:plastic");
  EXPECT_THAT(ErrorOf([&] { CompareAppearance(PictureDataOf(plastic), MaterialOf(aniso), {}); }),
              IsError(ErrorKind::kUnsupported, {.file = "synth:plastic", .key = "anisotropic"}));
}

// At theta = 0 each phi is a node of its own, as in the objective.
TEST(ReconstructAtNodes, IsTheModelAtUtiasDirections) {
  FactorModel model(ModelSpec::Anisotropic(2));
  double x = 0.3;
  for (double& number : model.parameters()) number = x = 3.7 * x * (1 - x);
  const HemisphereGrid grid{3, 8};
  const Measurement measurement = ReconstructAtNodes(model, "m.json", grid);
  ASSERT_EQ(measurement.samples.size(), 24 * 24);
  EXPECT_TRUE(measurement.anisotropic);
  for (int j = 0; j < measurement.samples.size(); ++j) {
    const SphericalAngles& at = measurement.samples.directions[j];
    const SampleStencils stencils = ScatteredStencils(model.spec(), at);
    for (int c = 0; c < kChannels; ++c) {
      const double rho = UnclampedValue(model, stencils, c);
      EXPECT_NEAR(measurement.samples.rho[j][c], rho, 1e-7 * rho);
    }
  }
  model.d()[0] = 1e308;
  for (double& s : model.s(0)) s = 1e308;
  EXPECT_THAT(ErrorOf([&] { ReconstructAtNodes(model, "m.json", grid); }),
              IsError(ErrorKind::kData, {.file = "m.json", .key = "model", .value = "overflow"}));
}

// Anywhere, of a value that theta_h says.
Measurement Sampled(int samples, bool anisotropic) {
  SampleCollector collector("dense.csv", "test");
  Random random(1);
  for (int j = 0; j < samples; ++j) {
    const SphericalAngles at = {random.Uniform(0, 1.57), 0, random.Uniform(0, 1.57),
                                random.Uniform(0, 2 * kPi)};
    const double rho = 1 + ToHalfDiff(ToDirections(at)).theta_h;
    collector.Add(at, {rho, 2 * rho, 3 * rho});
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = anisotropic;
  return measurement;
}

TEST(TableOfSamples, IsTheMeanInTheBinsOfDenseSamples) {
  const std::optional<BrdfTable> table = TableOfSamples(Sampled(100000, false));
  ASSERT_TRUE(table);
  const TabulatedBrdf brdf(*table);
  for (const double theta_h : {0.2, 0.5, 0.9}) {
    const Rgb rho = brdf.Interpolate(HalfDiffAngles{theta_h, 0.4, 1.5});
    EXPECT_NEAR(rho[0], 1 + theta_h, 0.08);
    EXPECT_NEAR(rho[2], 3 * (1 + theta_h), 0.24);
  }
}

TEST(TableOfSamples, IsNoneOfFewOrOfAnisotropicOnes) {
  EXPECT_FALSE(TableOfSamples(Sampled(1000, false)));
  EXPECT_FALSE(TableOfSamples(Sampled(100000, true)));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
