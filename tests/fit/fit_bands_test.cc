#include "trilobe/fit/fit_bands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/model/spectral_materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/fit.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// D and G of the material, and d, s and F that are not.
FactorModel Start(const SpectralModel& truth) {
  FactorModel start = truth.shared();
  for (double& x : start.d()) x = 0.05;
  for (int m = 0; m < start.spec().lobes; ++m) {
    for (double& x : start.s(m)) x = 0.3;
  }
  for (int t = 0; t < start.spec().num_tables(Factor::kF); ++t) {
    const auto F = start.table(Factor::kF, t);
    if (start.spec().F.per_channel) {
      for (size_t k = 0; k < F.size(); ++k) F[k] = 1 + 0.02 * static_cast<double>(k);
    } else {  // is held
      std::ranges::copy(truth.F(0, 0), F.begin());
    }
  }
  return start;
}

Objective ObjectiveOf(const Measurement& measurement, const ModelSpec& spec) {
  return {SamplesOf(measurement), spec, FindWeighting("appearance")};
}

std::vector<NamedSpec> Specs() {
  ModelSpec narrow = ModelSpec::SharedFactors(2);
  narrow.f_axis.size = 12;
  ModelSpec by_lobe = narrow, one_F = narrow, anisotropic = ModelSpec::Anisotropic(2);
  by_lobe.F.per_lobe = true;
  one_F.F.per_channel = false;
  anisotropic.f_axis.size = 6;
  return {
      {"default", narrow}, {"F by lobe", by_lobe}, {"one F", one_F}, {"anisotropic", anisotropic}};
}

TEST(FitBands, FindsEachBandOfAKnownMaterial) {
  for (const auto& [name, spec] : Specs()) {
    SCOPED_TRACE(name);
    const SpectralModel truth = AnalyticSpectralModel(spec, VisibleWavelengths(31));
    const BandsFit fit = FitBands(ObjectiveOf(MeasureSpectra(truth, 2500), spec), Start(truth));
    ASSERT_EQ(fit.model.bands(), 31);
    EXPECT_EQ(fit.model.wavelengths(), truth.wavelengths());
    for (int l = 0; l < 31; ++l) {
      EXPECT_LT(fit.Relative(l), 1e-8);
      EXPECT_NEAR(fit.model.d()[l], truth.d()[l], 1e-4);
      // 70 degrees of theta_d and more are seen by few samples.
      for (int m = 0; m < spec.lobes; ++m) {
        for (int k = 0; k < spec.f_axis.size * 7 / 9; ++k) {
          const double expected = truth.s(m)[l] * truth.F(m, l)[k];
          EXPECT_NEAR(fit.model.s(m)[l] * fit.model.F(m, l)[k], expected, 5e-3 * expected);
        }
      }
    }
  }
}

double BandError(const SpectralModel& model, const Objective& objective, int band) {
  std::vector<double> rho(model.bands());
  double E = 0;
  for (int j = 0; j < objective.samples().size(); ++j) {
    const WeightedSample sample = objective.Sample(j);
    UnclampedValues(model, sample.stencils, rho);
    const double off = rho[band] - objective.samples().SpectrumOf(j)[band];
    E += sample.weight[0] * off * off;
  }
  return E;
}

// Other d, s and F are tried: they differ by as little as a thousandth, or by much.
TEST(FitBands, NoOtherParametersOfABandHaveALowerE) {
  const ModelSpec spec = Specs()[0].spec;
  const SpectralModel truth = AnalyticSpectralModel(spec, VisibleWavelengths(7));
  const Objective objective = ObjectiveOf(MeasureSpectra(truth, 1000, 0.1), spec);
  const BandsFit fit = FitBands(objective, Start(truth));
  Random random(5);
  for (const double size : {1e-3, 1e-2, 0.3}) {
    SpectralModel other = fit.model;
    for (int k = 0; k < 5; ++k) {
      for (int l = 0; l < 7; ++l) {
        other.d()[l] = fit.model.d()[l] * random.LogNormal(size);
        for (int m = 0; m < spec.lobes; ++m) {
          other.s(m)[l] = fit.model.s(m)[l] * random.LogNormal(size);
        }
        for (int e = 0; e < spec.f_axis.size; ++e) {
          other.F(0, l)[e] = fit.model.F(0, l)[e] * random.LogNormal(size);
        }
        EXPECT_GE(BandError(other, objective, l), fit.objective[l] * (1 - 1e-9));
      }
    }
  }
  // Another start of another shape ends at the same E.
  FactorModel start = Start(truth);
  for (int c = 0; c < kChannels; ++c) {
    start.d()[c] = 0;
    start.s(1)[c] = 0.01;
    for (double& x : start.table(Factor::kF, c)) x = random.Uniform(0.1, 3);
  }
  const BandsFit again = FitBands(objective, start);
  for (int l = 0; l < 7; ++l) EXPECT_NEAR(again.objective[l] / fit.objective[l], 1, 1e-5);
}

// The bands are the channels themselves, and none is worse than in the fit of all three.
TEST(FitBands, AreNoWorseThanTheChannelsOfTheFit) {
  const ModelSpec spec = Specs()[0].spec;
  const SpectralModel truth = AnalyticSpectralModel(spec, VisibleWavelengths(7));
  Measurement measurement = MeasureSpectra(truth, 1000, 0.1);
  Spectra channels = {VisibleWavelengths(7), {}};  // R, G, B, R, G, B, R
  for (const Rgb& rho : measurement.samples.rho) {
    for (int l = 0; l < 7; ++l) channels.values.push_back(rho[l % kChannels]);
  }
  measurement.samples.SetSpectra(channels);
  FitOptions options;
  options.form.lobes = 2;
  options.bands = true;
  options.compare = false;
  const FitResult fit = Fit(measurement, options);
  ASSERT_TRUE(fit.bands.has_value());
  const Objective& objective = fit.objective;
  for (int c = 0; c < kChannels; ++c) {
    double E = 0;
    for (int j = 0; j < objective.samples().size(); ++j) {
      const WeightedSample sample = objective.Sample(j);
      const double off = UnclampedValue(fit.model(), sample.stencils, c) - sample.rho[c];
      E += sample.weight[c] * off * off;
    }
    EXPECT_LE(fit.bands->objective[c], E * (1 + 1e-9));
    EXPECT_DOUBLE_EQ(fit.bands->objective[c], fit.bands->objective[3 + c]);
  }
}

TEST(FitBands, AreTheSameForAnyNumberOfThreads) {
  const ModelSpec spec = Specs()[0].spec;
  const SpectralModel truth = AnalyticSpectralModel(spec, VisibleWavelengths(7));
  const BrdfSamples samples = SamplesOf(MeasureSpectra(truth, 500, 0.1));
  const Weighting weighting = FindWeighting("appearance");
  const BandsFit one = FitBands(Objective(samples, spec, weighting, 1), Start(truth));
  const BandsFit four = FitBands(Objective(samples, spec, weighting, 4), Start(truth));
  EXPECT_EQ(one.objective, four.objective);
  for (int l = 0; l < 7; ++l) {
    EXPECT_THAT(one.model.F(0, l), testing::ElementsAreArray(four.model.F(0, l)));
  }
}

// Lobes that share F reflect 4 s together; and F goes on where no sample reads it.
TEST(FitBands, HaveTheCanonicalScale) {
  ModelSpec spec = ModelSpec::SharedFactors(1);
  const SpectralModel truth = AnalyticSpectralModel(spec, VisibleWavelengths(7));
  Measurement measurement = MeasureSpectra(truth, 3000);
  LimitAngles(0.8, &measurement);  // nothing of theta_d beyond 46 degrees
  const Objective objective = ObjectiveOf(measurement, spec);
  const BandsFit fit = FitBands(objective, Start(truth));
  const FactorModel three = fit.model.ThreeBands(2);
  const LobeLight light = ComputeLobeLight(objective.coverage(), three);
  for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(light.lobes[0][c] / (4 * three.s(0)[c]), 1, 1e-9);
  const std::span<const double> F = fit.model.F(0, 2);
  for (int k = 60; k < 90; ++k) {
    EXPECT_NEAR(F[k] / F[59], (1 + 0.02 * k) / (1 + 0.02 * 59), 1e-9);  // Start's ratio
  }
}

TEST(FitBands, AskForSpectraAndSharedTables) {
  const ModelSpec spec = ModelSpec::SharedFactors(1);
  Measurement measurement = MeasureSpectra(AnalyticSpectralModel(spec, VisibleWavelengths(7)), 50);
  const auto error = [&](const FitOptions& options) {
    return ErrorOf([&] { Fit(measurement, options); });
  };
  FitOptions options{.bands = true};
  options.choose_form = true;
  EXPECT_THAT(error(options), IsError(ErrorKind::kConflict, {.key = "spectral", .value = "auto"}));
  options.choose_form = false;
  options.start_model = FactorModel(ModelSpec::IndependentG());
  EXPECT_THAT(error(options), IsError(ErrorKind::kConflict, {.key = "spectral", .value = "D, G"}));
  options.start_model.reset();
  measurement.samples.spectra = nullptr;
  EXPECT_THAT(error(options), IsError(ErrorKind::kMissing, {.key = "spectra"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
