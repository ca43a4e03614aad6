// Whether samples whose azimuths are given get an isotropic or an anisotropic model.

#include "fit/azimuths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

#include "fit/choose_azimuths.h"
#include "model/measurement/counter_random.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

// The default form of a measurement, by few iterations.
FitResult FitShortly(const Measurement& measurement, FormOptions form = {}) {
  FitOptions options;
  options.form = std::move(form);
  options.solver = "varpro";
  options.solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions{.max_iterations = 2, .diagnose = false};
  };
  options.compare = false;
  options.raw = true;  // leaves out what follows the solver
  return Fit(measurement, options);
}

// The same samples with light from azimuth 0.
Measurement TurnedBack(const Measurement& scattered) {
  SampleCollector collector("turned back", "test");
  for (int j = 0; j < scattered.samples.size(); ++j) {
    SphericalAngles at = scattered.samples.directions[j];
    at.phi_o -= at.phi_i;
    at.phi_i = 0;
    collector.Add(at, scattered.samples.rho[j]);
  }
  return collector.TakeByAzimuths();
}

// Samples of a formula at random directions, each with the material turned differently.
Measurement Scattered(const char* material, int count) {
  const SynthMaterial& of = FindSynthMaterial(material);
  SampleCollector collector(material, "test");
  for (int j = 0; j < count; ++j) {
    const auto random = [&](int k) { return UniformAt(7, 4 * j + k); };
    const SphericalAngles at = {1.3 * random(0), 2 * kPi * random(1), 1.3 * random(2),
                                2 * kPi * random(3)};
    collector.Add(at, of.brdf(ToDirections(at)));
  }
  return collector.TakeByAzimuths();
}

TEST(Azimuths, DoNotMatterWhereTurnsDifferByNoiseAlone) {
  for (const char* const material : {"synth:copper@6x24", "synth:felt@6x24"}) {
    for (const uint64_t seed : {1, 2}) {
      const Measurement noisy = LoadMeasurement(material, {.noise = 0.05, .seed = seed});
      ASSERT_TRUE(noisy.anisotropic);
      const FitResult fit = FitShortly(noisy);
      EXPECT_FALSE(fit.model().spec().anisotropic()) << material;
      ASSERT_TRUE(fit.azimuths) << material;
      EXPECT_FALSE(fit.azimuths->matter) << material;
      EXPECT_THAT(fit.azimuths->why, HasSubstr("beyond noise"));
    }
  }
}

TEST(Azimuths, MatterWhereTurnsDifferByLittleButSmoothly) {
  for (const char* const material : {"synth:linen@6x24", "synth:enamelled_metal@6x24",
                                     "synth:charmeuse@6x24", "synth:velvet@4x8"}) {
    const Measurement noisy = LoadMeasurement(material, {.noise = 0.03});
    const AzimuthChoice choice = ChooseAzimuths(
        noisy, {}, [](const auto&, const auto&) { return std::optional<FactorModel>(); });
    EXPECT_TRUE(choice.matter) << material;
  }
}

// To keep the default nodes is no wish for an anisotropic model, but nodes of one are.
TEST(Azimuths, AreChosenWhateverRuleNodesHaveButByHeldOutDirections) {
  using NodeRule = FormOptions::NodeRule;
  const Measurement cloth = Scattered("linen", 100);
  FitOptions options;
  for (const NodeRule rule : {NodeRule::kFinerWhereSeen, NodeRule::kGiven, NodeRule::kHeldOut}) {
    options.form.nodes = rule;
    EXPECT_EQ(ChoosesAzimuths(cloth, options), rule != NodeRule::kHeldOut);
  }
}

TEST(Azimuths, OfFewSamplesDoNotMakeAnAnisotropicModel) {
  const Measurement few = Scattered("charmeuse", 300);
  const FitResult fit = FitShortly(few);
  EXPECT_FALSE(fit.model().spec().anisotropic());
  EXPECT_THAT(fit.azimuths->why, HasSubstr("300 samples are too few"));
  // Unless somebody asks for one, or says that they matter.
  EXPECT_TRUE(
      FitShortly(few, {.kind = FormOptions::Kind::kAnisotropic}).model().spec().anisotropic());
  Measurement said = few;
  said.azimuths_matter = true;
  EXPECT_TRUE(FitShortly(said).model().spec().anisotropic());
}

TEST(Azimuths, HeldOutSamplesDecideWhereNothingIsTurned) {
  const FormOptions one_lobe{.lobes = 1};
  const AzimuthChoice silk = *FitShortly(Scattered("charmeuse", 1300), one_lobe).azimuths;
  EXPECT_TRUE(silk.matter) << silk.why;
  const AzimuthChoice plastic = *FitShortly(Scattered("plastic", 1300), one_lobe).azimuths;
  EXPECT_FALSE(plastic.matter) << plastic.why;
  for (const AzimuthChoice& choice : {silk, plastic}) {
    EXPECT_THAT(choice.why, HasSubstr("held-out samples is"));
  }
}

// An isotropic material has the same model, but for rounding, wherever its light comes from.
TEST(Azimuths, ThatDoNotMatterChangeNothing) {
  const Measurement turned = Scattered("felt", 400);
  ASSERT_TRUE(turned.anisotropic);
  const FitResult one = FitShortly(turned), other = FitShortly(TurnedBack(turned));
  EXPECT_FALSE(other.azimuths);
  ASSERT_EQ(one.model().spec(), other.model().spec());
  EXPECT_NEAR(one.score.objective, other.score.objective, 1e-6 * other.score.objective);
}

TEST(Azimuths, AreChosenOnceForJudgesBesideAFit) {
  const Measurement noisy = LoadMeasurement("synth:copper@6x24", {.noise = 0.02});
  const Measurement chosen = WithAzimuthsChosen(noisy, {});
  EXPECT_FALSE(chosen.anisotropic);
  EXPECT_THAT(chosen.notes.back(), HasSubstr("isotropic: turned about its normal"));
  EXPECT_FALSE(FitShortly(chosen).azimuths);
  const Measurement silk = WithAzimuthsChosen(LoadMeasurement("synth:charmeuse@6x24"), {});
  EXPECT_TRUE(silk.anisotropic);
  EXPECT_TRUE(silk.azimuths_matter);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
