#include "trilobe/model/spectral_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/model/spectral_materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

std::vector<NamedSpec> SpectralSpecs() {
  ModelSpec by_lobe = ModelSpec::SharedFactors(3);
  by_lobe.F.per_lobe = true;
  ModelSpec one_F = ModelSpec::SharedFactors(2);
  one_F.F.per_channel = false;
  ModelSpec stretched = ModelSpec::SharedFactors(2);
  stretched.stretches = Stretch{.along = 0.5, .across = -0.2};
  return {{"default", ModelSpec::SharedFactors(3)},
          {"F by lobe", by_lobe},
          {"one F", one_F},
          {"stretched", stretched},
          {"anisotropic", ModelSpec::Anisotropic(2)},
          {"no lobes", ModelSpec::SharedFactors(0)}};
}

DirectionPair AnyPair(Random* random) {
  return {DirectionAt(random->Uniform(0, 1.5), random->Uniform(0, 6)),
          DirectionAt(random->Uniform(0, 1.5), random->Uniform(0, 6))};
}

TEST(SpectralModel, ValuesAreThoseOfItsBandsByThrees) {
  for (const auto& [name, spec] : SpectralSpecs()) {
    SCOPED_TRACE(name);
    const SpectralModel model = AnalyticSpectralModel(spec, VisibleWavelengths(8));
    Random random(2);
    for (int k = 0; k < 50; ++k) {
      const DirectionPair pair = AnyPair(&random);
      const std::vector<double> rho = Evaluate(model, pair);
      ASSERT_EQ(rho.size(), 8);
      for (int l = 0; l < 8; ++l) {
        const double of_three = Evaluate(model.ThreeBands(l), pair)[0];
        EXPECT_NEAR(rho[l], of_three, 1e-14 * of_three);
      }
    }
  }
}

TEST(SpectralModel, ColourIsTheIntegralOfItsSpectrum) {
  for (const auto& [name, spec] : SpectralSpecs()) {
    SCOPED_TRACE(name);
    const SpectralModel model = AnalyticSpectralModel(spec, VisibleWavelengths(31));
    const FactorModel rgb = model.ToRgb();
    const SpectralColor color(model.wavelengths(), "test");
    Random random(3);
    for (int k = 0; k < 50; ++k) {
      const DirectionPair pair = AnyPair(&random);
      EXPECT_LT(RelativeDistance(Evaluate(rgb, pair), color(Evaluate(model, pair))), 1e-12);
    }
  }
}

TEST(SpectralModel, OneWavelengthIsGrey) {
  const SpectralModel model = AnalyticSpectralModel(ModelSpec::SharedFactors(2), {1550});
  const FactorModel rgb = model.ToRgb();
  EXPECT_EQ(rgb.spec(), model.spec());
  const DirectionPair pair = {DirectionAt(0.3, 0), DirectionAt(0.9, 3)};
  const double rho = Evaluate(model, pair).at(0);
  for (const double x : Evaluate(rgb, pair)) EXPECT_DOUBLE_EQ(x, rho);
}

TEST(SpectralModel, CountsWhatIsIndependent) {
  const auto count = [](const ModelSpec& spec) {
    return SpectralModel(spec, VisibleWavelengths(7)).num_parameters();
  };
  EXPECT_EQ(count(ModelSpec::SharedFactors(3)), 7 + 21 + 270 + 7 * 90 + 270);
  EXPECT_EQ(count(ModelSpec::SharedFactors(0)), 7);
  EXPECT_EQ(count(SpectralSpecs()[2].spec), 7 + 14 + 180 + 90 + 180);
}

TEST(SpectralModel, IsZeroBelowTheSurface) {
  const SpectralModel model = AnalyticSpectralModel(ModelSpec::SharedFactors(1), {500});
  EXPECT_EQ(Evaluate(model, {DirectionAt(0.3, 0), {0, 0.6, -0.8}}).at(0), 0);
}

TEST(SpectralModel, RefusesWhatIsNone) {
  const auto error = [](const ModelSpec& spec, const std::vector<double>& wavelengths) {
    return ErrorOf([&] { SpectralModel(spec, wavelengths); });
  };
  const ModelSpec spec = ModelSpec::SharedFactors(1);
  EXPECT_THAT(error(spec, {}), IsError(ErrorKind::kRange, {.key = "bands"}));
  EXPECT_THAT(error(spec, std::vector<double>(1025, 500)),
              IsError(ErrorKind::kRange, {.key = "bands"}));
  EXPECT_THAT(error(spec, {500, 450}),
              IsError(ErrorKind::kRange, {.key = "wavelengths", .value = "450"}));
  EXPECT_THAT(error(spec, {500, 550}),
              IsError(ErrorKind::kMissing, {.key = "wavelengths", .value = "550"}));
  EXPECT_THAT(error(spec, {0}), IsError(ErrorKind::kRange, {.key = "wavelengths"}));
  EXPECT_THAT(error(spec, {std::numeric_limits<double>::infinity()}),
              IsError(ErrorKind::kRange, {.key = "wavelengths"}));
  EXPECT_THAT(error(ModelSpec::IndependentG(), {500}),
              IsError(ErrorKind::kUnsupported, {.key = "D, G"}));
  SpectralModel model = AnalyticSpectralModel(spec, VisibleWavelengths(7));
  model.s(0)[4] = -1;
  EXPECT_THAT(ErrorOf([&] { CheckParameters(model); }),
              IsError(ErrorKind::kData, {.key = "parameter 4", .value = "-1"}));
}

TEST(Spectra, StayWithTheirSamples) {
  const SpectralModel model =
      AnalyticSpectralModel(ModelSpec::SharedFactors(1), VisibleWavelengths(7));
  Measurement measurement = MeasureSpectra(model, 100);
  LimitAngles(0.9, &measurement);
  ASSERT_LT(measurement.samples.size(), 90);
  for (int j = 0; j < measurement.samples.size(); ++j) {
    const std::vector<double> rho =
        Evaluate(model, ToDirections(measurement.samples.directions[j]));
    EXPECT_THAT(measurement.samples.SpectrumOf(j), testing::ElementsAreArray(rho));
  }
  EXPECT_THAT(ErrorOf([&] {
                measurement.samples.SetSpectra({{500}, {1, 2}});
              }),
              IsError(ErrorKind::kMismatch, {.key = "spectra", .value = "2"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
