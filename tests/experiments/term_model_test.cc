#include "experiments/limits/term_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "experiments/limits/term_forms.h"
#include "tests/error_of.h"
#include "tests/model/spectral_materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 7, .phi_d = 12};

DirectionPair AnyPair(Random* random) {
  return {DirectionAt(random->Uniform(0, 1.5), random->Uniform(0, 6)),
          DirectionAt(random->Uniform(0, 1.5), random->Uniform(0, 6))};
}

TEST(TermModel, OfAFactorModelHasItsValues) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    SCOPED_TRACE(name);
    const FactorModel model = RandomModel(spec, 3);
    const TermModel terms = TermModel::Of(model);
    EXPECT_EQ(terms.num_parameters(), spec.num_parameters());
    Random random(1);
    for (int k = 0; k < 20; ++k) {
      const DirectionPair pair = AnyPair(&random);
      const Rgb expected = Evaluate(model, pair);
      const std::vector<double> rho = Evaluate(terms, pair);
      for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(rho[c], expected[c], 1e-12 * expected[c]);
    }
  }
}

TEST(TermModel, OfASpectralModelHasAChannelAWavelength) {
  ModelSpec by_lobe = ModelSpec::SharedFactors(3);
  by_lobe.F.per_lobe = true;
  for (const ModelSpec& spec : {ModelSpec::SharedFactors(2), by_lobe}) {
    const SpectralModel model = AnalyticSpectralModel(spec, VisibleWavelengths(7));
    const TermModel terms = TermModel::Of(model);
    Random random(1);
    for (int k = 0; k < 20; ++k) {
      const DirectionPair pair = AnyPair(&random);
      const std::vector<double> expected = Evaluate(model, pair), rho = Evaluate(terms, pair);
      ASSERT_EQ(rho.size(), 7);
      for (int c = 0; c < 7; ++c) EXPECT_NEAR(rho[c], expected[c], 1e-12 * expected[c]);
    }
  }
}

TEST(TermModel, AnisotropicModelsAreRefused) {
  EXPECT_THAT(
      ErrorOf([&] { TermSpec::Of(ModelSpec::Anisotropic(1)); }),
      IsError(ErrorKind::kUnsupported, {.key = "anisotropic", .value = "a model of terms"}));
}

// Heitz (2014), eq. 99, and with the correlation of azimuths; derivatives by differences.
TEST(TermModel, PairsAreWhatTheirFormulasSay) {
  EXPECT_DOUBLE_EQ(ValueOfRead(Site::kHeightCorrelated, 0.5, 0.25, 0.3).value, 1 / 1.75);
  EXPECT_DOUBLE_EQ(ValueOfRead(Site::kDirectionCorrelated, 0.5, 0.25, 0.3).value,
                   1 / (1.5 + 0.3 * 0.25));
  EXPECT_DOUBLE_EQ(ValueOfRead(Site::kInTimesOut, 0.5, 0.25, 0.3).value, 0.125);
  Random random(2);
  for (const Site site : kSites) {
    for (int k = 0; k < 20; ++k) {
      const double in = random.Uniform(0.1, 2), out = random.Uniform(0.1, 2), l = random.Uniform();
      const ReadValue at = ValueOfRead(site, in, out, l);
      constexpr double kStep = 1e-6;
      EXPECT_NEAR((ValueOfRead(site, in + kStep, out, l).value - at.value) / kStep, at.by_in, 1e-5);
      EXPECT_NEAR((ValueOfRead(site, in, out + kStep, l).value - at.value) / kStep, at.by_out,
                  1e-5);
    }
  }
}

// `correlation` is 0 where both directions have one azimuth, and l = 4.41 pi / (4.41 pi + 1) where
// these are half a turn apart.
TEST(TermModel, CorrelationGoesByTheAzimuthBetween) {
  const TermReader reader(TermSpec::Of(ModelSpec::SharedFactors(1)));
  const auto at = [&](double phi) {
    return reader.StencilsAt(ToHalfDiff({DirectionAt(0.7, 0), DirectionAt(0.5, phi)})).correlation;
  };
  EXPECT_NEAR(at(0), 0, 1e-6);
  EXPECT_NEAR(at(kPi), 4.41 * kPi / (4.41 * kPi + 1), 1e-12);
  EXPECT_LT(at(0.5), at(1.5));
}

TEST(TermForms, StartFromTheValuesOfTheFit) {
  const FactorModel model = AnalyticModel(ModelSpec::SharedFactors(3), 0.2, 0.3);
  const TermModel paper = TermModel::Of(model);
  for (const TermForm& form : TermForms()) {
    SCOPED_TRACE(form.name);
    const TermModel start = form.from(paper);
    Random random(1);
    for (int k = 0; k < 20; ++k) {
      const DirectionPair pair = AnyPair(&random);
      const std::vector<double> rho = Evaluate(start, pair), was = Evaluate(paper, pair);
      const std::vector<double> exchanged = Evaluate(start, {pair.wo, pair.wi});
      for (int c = 0; c < kChannels; ++c) {
        EXPECT_TRUE(rho[c] > 0 && std::isfinite(rho[c]));
        EXPECT_NEAR(exchanged[c], rho[c], 1e-9 * rho[c]);  // reciprocal
        if (form.name == "paper" || form.name == "diffuse_table" || form.name == "own_f") {
          EXPECT_NEAR(rho[c], was[c], 1e-12 * was[c]);
        }
      }
    }
  }
}

TEST(TermForms, CoupledDiffuseIsThatOfAshikhminAndShirley) {
  const TermForm& form = TermForms()[2];
  ASSERT_EQ(form.name, "coupled_diffuse");
  FactorModel lambert(ModelSpec::SharedFactors(1));
  lambert.d()[0] = 1;
  const TermModel coupled = form.from(TermModel::Of(lambert));
  EXPECT_EQ(coupled.num_parameters(), lambert.spec().num_parameters());  // T is fixed
  const auto value = [&](double theta_i, double theta_o) {
    return Evaluate(coupled, {DirectionAt(theta_i, 0), DirectionAt(theta_o, 2)})[0];
  };
  const auto formula = [](double theta_i, double theta_o) {
    const auto passed = [](double theta) { return 1 - std::pow(1 - std::cos(theta) / 2, 5); };
    return passed(theta_i) * passed(theta_o);
  };
  for (const double theta : {0.1, 0.5, 1.0, 1.3}) {
    EXPECT_NEAR(value(theta, 0.8) / value(0.3, 0.4), formula(theta, 0.8) / formula(0.3, 0.4), 1e-3);
  }
}

TEST(TermForms, RetroIsBrightestWhereLightComesFrom) {
  const TermModel retro =
      TermForms().back().from(TermModel::Of(FactorModel(ModelSpec::SharedFactors(1))));
  ASSERT_EQ(TermForms().back().name, "retro");
  const Direction wi = DirectionAt(0.8, 0.3);
  const double back = Evaluate(retro, {wi, wi})[0];
  EXPECT_GT(back, 0);
  EXPECT_NEAR(Evaluate(retro, {wi, DirectionAt(0.8, 0.3 + kPi)})[0] / back, 1e-3, 1e-3);
}

TEST(TermForms, FormsThatNeedLobesSaySo) {
  const TermModel lambert = TermModel::Of(FactorModel(ModelSpec::SharedFactors(0)));
  for (const TermForm& form : TermForms()) {
    if (form.name == "correlated_g" || form.name == "own_f") {
      EXPECT_THAT(ErrorOf([&] { form.from(lambert); }),
                  IsError(ErrorKind::kUnsupported, {.key = "lobes", .value = "0"}))
          << form.name;
    }
  }
}

TEST(TermSpec, WhatIsWrongIsNamed) {
  const auto error_of = [](void (*spoil)(TermSpec*)) {
    TermSpec spec = TermSpec::Of(ModelSpec::SharedFactors(2));
    spoil(&spec);
    return ErrorOf([&] { CheckTerms(spec); });
  };
  EXPECT_NO_THROW(CheckTerms(TermSpec::Of(ModelSpec::SharedFactors(2))));
  EXPECT_THAT(error_of([](TermSpec* spec) { spec->channels = 65; }),
              IsError(ErrorKind::kMismatch, {.key = "channels", .value = "65"}));
  EXPECT_THAT(error_of([](TermSpec* spec) { spec->terms.clear(); }),
              IsError(ErrorKind::kMismatch, {.key = "terms", .value = "0"}));
  EXPECT_THAT(error_of([](TermSpec* spec) { spec->terms[1].reads[0].table = 2; }),
              IsError(ErrorKind::kRange, {.key = "lobe 1", .value = "2"}));
  EXPECT_THAT(error_of([](TermSpec* spec) { spec->terms[1].reads.resize(5); }),
              IsError(ErrorKind::kMismatch, {.key = "lobe 1", .value = "5"}));
  EXPECT_THAT(error_of([](TermSpec* spec) { spec->terms[1].reads[1].stretch.along = 1; }),
              IsError(ErrorKind::kUnsupported, {.key = "lobe 1", .value = "stretch"}));
  EXPECT_THAT(error_of([](TermSpec* spec) { spec->sets[1].axis = Axis::Utia(); }),
              IsError(ErrorKind::kUnsupported, {.key = "F"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
