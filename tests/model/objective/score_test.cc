#include "trilobe/model/objective/score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid = {.theta_h = 8, .theta_d = 8, .phi_d = 10};

// Three measured bins and a Lambertian model, so that every number can be worked out by hand.
BrdfSamples ThreeSamples() {
  BrdfSamples samples{
      "three", kGrid, {kGrid.Index(0, 0, 0), kGrid.Index(1, 2, 3), kGrid.Index(2, 1, 4)}, {}, {}};
  samples.rho = {{0.5, 0.2, 0.1}, {0.1, 0.2, 0.4}, {0.1, 1.2, 0.1}};
  return samples;
}

FactorModel Lambertian(double red, double green, double blue) {
  FactorModel model(ModelSpec::SharedFactors(0, kGrid));
  model.d()[0] = red;
  model.d()[1] = green;
  model.d()[2] = blue;
  return model;
}

TEST(ScoreTest, MatchesHandComputedNumbers) {
  const FactorModel model = Lambertian(0.1, 0.2, 0.1);
  const Objective objective(ThreeSamples(), model.spec(), FindWeighting("uniform"));
  const ScoreReport report = ScoreModel(objective, model);
  // Errors: red 0.4 at sample 0, blue 0.3 at sample 1, green 1.0 at sample 2.
  EXPECT_EQ(report.valid_samples, 3);
  EXPECT_NEAR(report.objective, 0.16 + 0.09 + 1, 1e-12);
  const double energy = 0.25 + 0.04 + 0.01 + 0.01 + 0.04 + 0.16 + 0.01 + 1.44 + 0.01;
  EXPECT_NEAR(report.relative_objective, 1.25 / energy, 1e-12);
  EXPECT_NEAR(report.rmse, std::sqrt(1.25 / 9), 1e-12);
  EXPECT_NEAR(report.rmse_channel[0], 0.4 / std::sqrt(3), 1e-12);
  EXPECT_NEAR(report.rmse_channel[1], 1.0 / std::sqrt(3), 1e-12);
  EXPECT_NEAR(report.rmse_channel[2], 0.3 / std::sqrt(3), 1e-12);
  EXPECT_NEAR(report.psnr_peak, 1.2, 1e-12);
  EXPECT_NEAR(report.psnr_db, 10 * std::log10(1.44 / (1.25 / 9)), 1e-9);
  EXPECT_NEAR(report.mean_relative_error, (0.4 / 0.501 + 0.3 / 0.401 + 1 / 1.201) / 9, 1e-12);
  const auto cos_i = [&](int j) { return ToCosines(objective.samples().Angles(j)).i; };
  const double log_error = std::abs(std::log((1 + 0.1 * cos_i(0)) / (1 + 0.5 * cos_i(0)))) +
                           std::abs(std::log((1 + 0.1 * cos_i(1)) / (1 + 0.4 * cos_i(1)))) +
                           std::abs(std::log((1 + 0.2 * cos_i(2)) / (1 + 1.2 * cos_i(2))));
  EXPECT_NEAR(report.mean_log_error, log_error / 9, 1e-12);
  EXPECT_NEAR(report.max_absolute_error, 1, 1e-12);
  ASSERT_EQ(report.worst.size(), 9U);
  EXPECT_EQ(report.worst[0].sample, 2);
  EXPECT_EQ(report.worst[0].channel, 1);
  EXPECT_NEAR(report.worst[0].measured, 1.2, 1e-12);
  EXPECT_NEAR(report.worst[0].fitted, 0.2, 1e-12);
  EXPECT_NEAR(report.worst[0].error, 1, 1e-12);
  EXPECT_NEAR(report.worst[0].angles.theta_d, kGrid.Center(2, 1, 4).theta_d, 1e-12);
  EXPECT_EQ(report.worst[1].channel, 0);
  EXPECT_EQ(report.worst[2].channel, 2);
}

// The same numbers for whatever has a value at each sample.
TEST(ScoreTest, ValuesScoreAsTheModelThatHasThem) {
  const BrdfTable table = RandomTable(kGrid, 1);
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const FactorModel model = RandomModel(spec, 2);
  for (const Weighting& weighting : Weightings()) {
    for (BrdfSamples samples : {ValidSamples(table), Scattered(ValidSamples(table))}) {
      samples.multiplicity.assign(samples.size(), 1);
      samples.multiplicity[1] = 3;
      const Objective objective(samples, spec, weighting);
      const ScoreReport a = ScoreModel(objective, model);
      const ScoreReport b = ScoreValues(objective, EvaluateSamples(model, samples, 1));
      EXPECT_NEAR(b.objective, a.objective, 1e-12 * a.objective) << weighting.name;
      EXPECT_NEAR(b.relative_objective, a.relative_objective, 1e-12 * a.relative_objective);
      EXPECT_EQ(b.rmse, a.rmse);
      EXPECT_EQ(b.psnr_db, a.psnr_db);
      EXPECT_EQ(b.mean_relative_error, a.mean_relative_error);
      EXPECT_EQ(b.worst[0].error, a.worst[0].error);
    }
  }
  const Objective objective(ThreeSamples(), spec, FindWeighting("uniform"));
  const ScoreReport exact = ScoreValues(objective, objective.samples().rho);
  EXPECT_EQ(exact.objective, 0);
  EXPECT_EQ(exact.psnr_db, std::numeric_limits<double>::infinity());
  std::vector<Rgb> huge = objective.samples().rho;
  huge[1][2] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(ErrorOf([&] { ScoreValues(objective, huge); }),
              IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}));
}

// Weights decide which samples are worst: percentage weighs the dim ones up.
TEST(ScoreTest, MeanLogErrorIsThatOfAllFigures) {
  const FactorModel model = Lambertian(0.1, 0.3, 0.2);
  const Objective objective(ThreeSamples(), model.spec(), FindWeighting("log"));
  EXPECT_NEAR(MeanLogError(objective.samples(), model), ScoreModel(objective, model).mean_log_error,
              1e-15);
}

TEST(ScoreTest, WorstSamplesAreWeighted) {
  const FactorModel model = Lambertian(0, 0, 0.1);
  BrdfSamples samples = ThreeSamples();
  samples.rho = {{1, 1, 0.1}, {1, 1, 0.101}, {1, 1, 0.001}};
  const Objective objective(samples, model.spec(), FindWeighting("percentage"));
  const ScoreReport report = ScoreModel(objective, model);
  EXPECT_EQ(report.worst[0].sample, 2);
  EXPECT_EQ(report.worst[0].channel, 2);
  EXPECT_NEAR(report.worst[0].error, std::pow(0.099 / 0.002, 2), 1e-9);
}

TEST(ScoreTest, ExactFitHasInfinitePsnr) {
  const FactorModel model = Lambertian(0.25, 0.5, 0.125);
  BrdfSamples samples = ThreeSamples();
  for (Rgb& rho : samples.rho) rho = {0.25, 0.5, 0.125};
  const ScoreReport report =
      ScoreModel(Objective(samples, model.spec(), FindWeighting("uniform")), model);
  EXPECT_EQ(report.psnr_db, std::numeric_limits<double>::infinity());
  EXPECT_EQ(report.rmse, 0);
}

TEST(ScoreTest, BlackMeasurementGivesFiniteErrors) {
  const FactorModel model = Lambertian(0.1, 0.1, 0.1);
  BrdfSamples samples = ThreeSamples();
  for (Rgb& rho : samples.rho) rho = {0, 0, 0};
  const ScoreReport report =
      ScoreModel(Objective(samples, model.spec(), FindWeighting("uniform")), model);
  EXPECT_EQ(report.psnr_peak, 0);
  EXPECT_EQ(report.psnr_db, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(report.relative_objective, 0);
  EXPECT_NEAR(report.rmse, 0.1, 1e-12);
  EXPECT_NEAR(report.mean_relative_error, 100, 1e-9);
}

TEST(ScoreTest, RejectsAModelThatOverflows) {
  FactorModel model(ModelSpec::SharedFactors(1, kGrid));
  for (double& x : model.parameters()) x = 1e300;
  const Objective objective(ThreeSamples(), model.spec(), FindWeighting("uniform"));
  EXPECT_THAT(ErrorOf([&] { ScoreModel(objective, model); }),
              IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}));
}

TEST(ScoreTest, IsTheSameForAnyNumberOfThreads) {
  const MerlGrid grid = {.theta_h = 30, .theta_d = 30, .phi_d = 60};
  BrdfTable table = MakeInvalidTable("ramp", grid);
  const std::vector<bool> above = BinsAboveSurface(grid);
  for (int bin = 0; bin < grid.size(); ++bin) {
    for (int c = 0; c < kChannels && above[bin]; ++c) {
      table.SetValue(c, bin, 0.1 + 0.001 * ((bin * 7919 + c) % 1000));
    }
  }
  FactorModel model(ModelSpec::SharedFactors(2, grid));
  for (double& x : model.parameters()) x = 0.3;
  const Weighting weighting = FindWeighting("compressive");
  const ScoreReport one =
      ScoreModel(Objective(ValidSamples(table), model.spec(), weighting, 1), model);
  const ScoreReport three =
      ScoreModel(Objective(ValidSamples(table), model.spec(), weighting, 3), model);
  EXPECT_EQ(one.rmse, three.rmse);
  EXPECT_EQ(one.mean_relative_error, three.mean_relative_error);
  EXPECT_EQ(one.mean_log_error, three.mean_log_error);
  ASSERT_EQ(one.worst.size(), 10U);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(one.worst[i].sample, three.worst[i].sample);
    EXPECT_EQ(one.worst[i].channel, three.worst[i].channel);
    EXPECT_LE(one.worst[i].error, one.worst[std::max(i - 1, 0)].error);
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
