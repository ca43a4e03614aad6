#include "io/formats/exports/rgl_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "io/formats/completed_measurement.h"
#include "io/formats/databases/rgl_file.h"
#include "io/formats/databases/tensor_file.h"
#include "tests/error_of.h"
#include "tests/model/materials.h"
#include "tests/model/spectral_materials.h"
#include "tests/paths.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/model/read_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::ElementsAre;

FactorModel Plastic() { return AnalyticModel(ModelSpec::SharedFactors(3), 0.1, 0.4); }

TEST(RglExport, IsTheModelWhereOurReaderLooks) {
  const FactorModel model = Plastic();
  const RglExport file = ExportRgl(model);
  EXPECT_LE(file.median_error, 0.005);
  EXPECT_LE(file.bytes.size(), 2300000U);
  const RglBrdf brdf = RglBrdf::Parse(file.bytes, "plastic.bsdf");
  EXPECT_TRUE(brdf.isotropic());
  Random random(1);
  std::vector<double> errors;
  for (int k = 0; k < 1000; ++k) {
    const DirectionPair pair = {DirectionAt(random.Uniform(0, 1.2), random.Uniform(-kPi, kPi)),
                                DirectionAt(random.Uniform(0, 1.2), random.Uniform(-kPi, kPi))};
    errors.push_back(RelativeDistance(brdf.Evaluate(pair), Evaluate(model, pair)));
  }
  std::ranges::sort(errors);
  EXPECT_LT(errors[500], 0.005);
  EXPECT_LT(errors[990], 0.1);
}

// Fields that Mitsuba 3 and powitacq_rgb ask for, one by one.
TEST(RglExport, HasTheFieldsThatRenderersRead) {
  const RglExport exported = ExportRgl(Plastic(), {.max_error = 1});
  const TensorFile file(exported.bytes, "plastic.bsdf");
  const int t = exported.theta_i, n = exported.resolution;
  EXPECT_EQ(file.Byte("jacobian"), 1);
  EXPECT_FALSE(file.Bytes("description").empty());
  EXPECT_THAT(file.Float32("phi_i", 1).shape, ElementsAre(1));
  const Tensor theta = file.Float32("theta_i", 1);
  EXPECT_THAT(theta.shape, ElementsAre(t));
  EXPECT_EQ(theta.values.front(), 0);
  EXPECT_NEAR(theta.values.back(), kPi / 2, 1e-6);
  EXPECT_THAT(file.Float32("rgb", 5).shape, ElementsAre(1, t, 3, n, n));
  EXPECT_THAT(file.Float32("luminance", 4).shape, ElementsAre(1, t, n, n));
  EXPECT_THAT(file.Float32("vndf", 4).shape, ElementsAre(1, t, 2, 361));
  for (const char* name : {"ndf", "sigma"}) {
    for (const double x : file.Float32(name, 2).values) EXPECT_GT(x, 0);
  }
  for (const double x : file.Float32("luminance", 4).values) EXPECT_GE(x, 0);
}

// Checks what pbrt-v4 asks for (MeasuredBRDF::Create): these fields and no other type or rank,
// extents that agree, and as many rows as columns.
void ExpectWhatPbrtReads(const RglExport& exported) {
  const TensorFile file(exported.bytes, "x.bsdf");
  const int p = exported.phi_i, t = exported.theta_i, n = exported.resolution;
  EXPECT_FALSE(file.Bytes("description").empty());
  EXPECT_EQ(file.Byte("jacobian"), 1);
  const Tensor phi = file.Float32("phi_i", 1), wavelengths = file.Float32("wavelengths", 1);
  EXPECT_THAT(phi.shape, ElementsAre(p));
  EXPECT_THAT(file.Float32("theta_i", 1).shape, ElementsAre(t));
  const int bands = wavelengths.shape[0];
  EXPECT_GE(bands, 2);
  EXPECT_TRUE(std::ranges::is_sorted(wavelengths.values, std::less_equal<>()));
  EXPECT_GE(wavelengths.values.front(), 360);
  EXPECT_LE(wavelengths.values.back(), 830);
  file.Float32("ndf", 2);
  file.Float32("sigma", 2);
  const std::vector<int> vndf = file.Float32("vndf", 4).shape;
  EXPECT_EQ(vndf[0], p);
  EXPECT_EQ(vndf[1], t);
  EXPECT_THAT(file.Float32("luminance", 4).shape, ElementsAre(p, t, n, n));
  const Tensor spectra = file.Float32("spectra", 5);
  EXPECT_THAT(spectra.shape, ElementsAre(p, t, bands, n, n));
  for (const double x : spectra.values) EXPECT_GE(x, 0);
  // It takes two azimuths or fewer as isotropic, and others only around the whole circle.
  if (p > 2) {
    EXPECT_EQ(std::lround(2 * kPi / (phi.values.back() - phi.values.front())), 1);
  }
  EXPECT_FALSE(file.Has("rgb"));  // Mitsuba's variants with RGB colours do not take such files
}

TEST(RglExport, SpectralFilesHaveTheFieldsThatPbrtReads) {
  ExpectWhatPbrtReads(ExportRgl(Plastic(), {.max_error = 1, .spectral = true}));
  ExpectWhatPbrtReads(ExportRgl(AnalyticModel(ModelSpec::Anisotropic(1), 0.4, 0.2),
                                {.max_error = 1, .spectral = true}));
}

// A spectral file can be read back, its spectra as well as its colours.
TEST(RglExport, ASpectralModelKeepsItsWavelengths) {
  const SpectralModel model =
      AnalyticSpectralModel(ModelSpec::SharedFactors(2), VisibleWavelengths(7));
  const RglExport file = ExportRgl(model);
  EXPECT_LE(file.median_error, 0.005);
  ExpectWhatPbrtReads(file);
  const RglBrdf brdf = RglBrdf::Parse(file.bytes, "x.bsdf");
  EXPECT_EQ(brdf.wavelengths(), model.wavelengths());
  Random random(1);
  std::vector<double> errors;
  for (int k = 0; k < 300; ++k) {
    const DirectionPair pair = {DirectionAt(random.Uniform(0, 1.2), random.Uniform(-kPi, kPi)),
                                DirectionAt(random.Uniform(0, 1.2), random.Uniform(-kPi, kPi))};
    const std::vector<double> read = brdf.Spectrum(pair), rho = Evaluate(model, pair);
    for (int l = 0; l < 7; ++l) errors.push_back(std::abs(read[l] / rho[l] - 1));
  }
  std::ranges::sort(errors);
  EXPECT_LT(errors[errors.size() / 2], 0.005);
  EXPECT_TRUE(
      RglBrdf::Parse(ExportRgl(Plastic(), {.max_error = 1}).bytes, "rgb").wavelengths().empty());
}

TEST(RglExport, SpectraHaveTheColoursOfTheModel) {
  const RglExport rgb = ExportRgl(Plastic(), {.max_error = 1});
  const RglExport spectral = ExportRgl(Plastic(), {.max_error = 1, .spectral = true});
  EXPECT_LT(spectral.color_error, 1e-4);
  EXPECT_EQ(spectral.colors_off, 0);
  EXPECT_NEAR(spectral.median_error, rgb.median_error, 1e-4);
  const RglBrdf a = RglBrdf::Parse(rgb.bytes, "a"), b = RglBrdf::Parse(spectral.bytes, "b");
  Random random(1);
  for (int k = 0; k < 1000; ++k) {
    const DirectionPair pair = {DirectionAt(random.Uniform(0, 1.5), random.Uniform(-kPi, kPi)),
                                DirectionAt(random.Uniform(0, 1.5), random.Uniform(-kPi, kPi))};
    EXPECT_LT(RelativeDistance(b.Evaluate(pair), a.Evaluate(pair)), 1e-4);
  }
}

// A measurement that the model is twice as dark as: its values, not the model's.
TEST(RglExport, HasTheValuesOfAMeasurement) {
  const FactorModel model = Plastic();
  FactorModel twice = model;
  for (int m = 0; m < 3; ++m) {
    for (double& s : twice.s(m)) s *= 2;
  }
  for (double& d : twice.d()) d *= 2;
  const Measurement measured = {
      .source = "twice", .kind = "test", .table = Reconstruct(twice, "twice")};
  const RglExport file = ExportRgl(model, Complete(measured, model, 1), {.max_error = 0.02});
  EXPECT_LE(file.median_error, 0.02);
  const RglBrdf brdf = RglBrdf::Parse(file.bytes, "twice.bsdf");
  const DirectionPair pair = {DirectionAt(0.4, 0.1), DirectionAt(0.5, 2.5)};
  EXPECT_LT(RelativeDistance(brdf.Evaluate(pair), Evaluate(twice, pair)), 0.05);
}

// Noise that no table follows is no reason to write none, and none for a large one.
TEST(RglExport, OfANoisyMeasurementIsTheSmallestThatIsHardlyWorse) {
  const FactorModel model = Plastic();
  Random random(1);
  Measurement noisy = {.source = "noisy", .kind = "test", .table = Reconstruct(model, "noisy")};
  for (std::vector<double>& plane : noisy.table->stored) {
    for (double& x : plane) x *= x < 0 ? 1 : std::max(1 + 0.2 * random.Normal(), 0.0);
  }
  const CompletedMeasurement completed = Complete(noisy, model, 1);
  const RglExport file = ExportRgl(model, completed);
  EXPECT_GT(file.median_error, 0.05);
  EXPECT_LE(file.bytes.size(), 400000U);
  EXPECT_THAT(ErrorOf([&] { ExportRgl(model, completed, {.max_error = 0.001}); }),
              IsError(ErrorKind::kLimit, {.key = "max_error", .value = "0.001"}));
}

TEST(RglExport, TakesAnisotropicModelsAroundTheWholeCircle) {
  const RglExport file =
      ExportRgl(AnalyticModel(ModelSpec::Anisotropic(2), 0.3, 0.2), {.max_error = 0.2});
  EXPECT_LE(file.median_error, 0.2);
  const std::vector<double> phi = TensorFile(file.bytes, "cloth.bsdf").Float32("phi_i", 1).values;
  EXPECT_NEAR(phi.back() - phi.front(), 2 * kPi, 1e-5);
  EXPECT_FALSE(RglBrdf::Parse(file.bytes, "cloth.bsdf").isotropic());
}

TEST(RglExport, TakesFinerTablesForLessError) {
  const FactorModel model = Plastic();
  const RglExport coarse = ExportRgl(model, {.max_error = 0.05}), fine = ExportRgl(model);
  EXPECT_LT(coarse.bytes.size(), fine.bytes.size());
  EXPECT_GT(coarse.median_error, fine.median_error);
  EXPECT_THAT(ErrorOf([&] { ExportRgl(model, {.max_error = 0}); }),
              IsError(ErrorKind::kLimit, {.key = "max_error", .value = "0"}));
}

TEST(RglExport, IsAsNearAsItComesWhereNothingElseIsAskedFor) {
  const FactorModel model = ReadModel(InRepository("materials/chm_mint.json")).model;
  const RglExport file = ExportRgl(model, {.max_theta = 1.4});
  EXPECT_GT(file.median_error, 0.002);
  EXPECT_LT(file.median_error, 0.02);
  EXPECT_THAT(ErrorOf([&] { ExportRgl(model, {.max_error = 0.002, .max_theta = 1.4}); }),
              IsError(ErrorKind::kLimit, {.key = "max_error", .value = "0.002"}));
}

TEST(RglExport, RefusesABlackModel) {
  EXPECT_THAT(ErrorOf([&] { ExportRgl(FactorModel(ModelSpec::SharedFactors(1))); }),
              IsError(ErrorKind::kData, {.key = "model", .value = "black"}));
  EXPECT_THAT(ErrorOf([&] { ExportRgl(FactorModel(ModelSpec::Anisotropic(1))); }),
              IsError(ErrorKind::kData, {.key = "model", .value = "black"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
