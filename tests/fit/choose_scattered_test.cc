// --model=auto of samples that make no picture.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

#include "model/appearance/picture_data.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// A highlight over a diffuser, so dim that it takes no time to limit its albedo; one that is wider
// in some channels no D has that channels share.
Measurement Highlight(const Rgb& widths, size_t count) {
  SampleCollector collector("highlight", "test");
  for (const SphericalAngles& at : DirectionsBetween(1.2, count, Spread::kByHighlights)) {
    const HalfDiffAngles angles = ToHalfDiff(ToDirections(at));
    Rgb rho;
    for (int c = 0; c < kChannels; ++c) {
      const double x = angles.theta_h / widths[c];
      rho[c] = 0.2 * (0.05 + std::exp(-x * x));
    }
    collector.Add(at, rho);
  }
  return collector.Take();
}

Measurement ByChannel() { return Highlight({0.15, 0.25, 0.4}, 4000); }

FitOptions Auto(int max_parameters) {
  FitOptions options;
  options.form.lobes = 1;
  options.solver = "varpro";
  options.solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions{.max_iterations = 10, .diagnose = false};
  };
  options.compare = false;
  options.choose_form = true;
  options.max_parameters = max_parameters;
  return options;
}

FitOptions Default(FitOptions options) {
  options.choose_form = false;
  options.max_parameters = {};
  return options;
}

std::vector<double> Parameters(const FitResult& fit) {
  return {fit.model().parameters().begin(), fit.model().parameters().end()};
}

// How near it is where it has seen nothing [dB].
double Unseen(const FitResult& fit, const Rgb& widths) {
  const BrdfSamples samples = Highlight(widths, 7001).samples;
  return CompareSamples(samples, EvaluateSamples(fit.model(), samples, 1)).psnr_db;
}

TEST(FitOfScattered, ChoosesTheFormThatTheMaterialNeeds) {
  const Measurement measured = ByChannel();
  const FitOptions options = Auto(250);
  const FitResult fit = Fit(measured, options);
  const std::vector<Candidate>& candidates = fit.finished.candidates;
  const int chosen = fit.finished.chosen;
  ASSERT_GT(chosen, 0);
  EXPECT_EQ(candidates[0].name, "as fitted");
  EXPECT_GT(candidates[chosen].score, candidates[0].score + 0.5);
  EXPECT_TRUE(fit.model().spec().D.per_channel) << candidates[chosen].name;
  EXPECT_LE(fit.stored_parameters, 250);
  EXPECT_NEAR(fit.finished.held_out, 800, 200);
  EXPECT_EQ(fit.finished.too_few_to_choose, 0);
  const Rgb widths = {0.15, 0.25, 0.4};
  EXPECT_GT(Unseen(fit, widths), Unseen(Fit(measured, Default(options)), widths) + 6);
  // Forms are judged by fits to a part of the samples; the returned model is fitted to all.
  EXPECT_EQ(fit.score.valid_samples, measured.samples.size());
  EXPECT_EQ(fit.objective.spec(), fit.model().spec());
  EXPECT_EQ(fit.score.objective, fit.objective.Value(fit.model()));
}

TEST(FitOfScattered, KeepsTheDefaultWhereNoFormIsAhead) {
  const Measurement measured = Highlight({0.25, 0.25, 0.25}, 4000);
  const FitOptions options = Auto(250);
  const FitResult fit = Fit(measured, options);
  EXPECT_EQ(fit.finished.chosen, 0);
  EXPECT_FALSE(fit.file.layout);
  EXPECT_EQ(Parameters(fit), Parameters(Fit(measured, Default(options))));
}

TEST(FitOfScattered, IsTheSameForAnyNumberOfThreads) {
  FitOptions options = Auto(250);
  const FitResult one = Fit(ByChannel(), options);
  options.num_threads = 3;
  const FitResult three = Fit(ByChannel(), options);
  EXPECT_EQ(one.finished.chosen, three.finished.chosen);
  EXPECT_EQ(Parameters(one), Parameters(three));
  options.seed = 2;  // other samples are held out
  EXPECT_NE(Parameters(one), Parameters(Fit(ByChannel(), options)));
}

TEST(FitOfScattered, OfTooFewIsTheDefault) {
  const Measurement measured = Highlight({0.15, 0.25, 0.4}, 500);
  const FitResult fit = Fit(measured, Auto(250));
  EXPECT_GT(fit.finished.too_few_to_choose, 500);
  EXPECT_TRUE(fit.finished.candidates.empty());
  EXPECT_EQ(Parameters(fit), Parameters(Fit(measured, Default(Auto(250)))));
  // A budget is kept to in any case.
  const FitResult small = Fit(measured, Auto(60));
  EXPECT_LE(small.stored_parameters, 60);
  EXPECT_EQ(small.finished.too_few_to_choose, 0);
}

TEST(FitOfScattered, StoppedWhileItChoosesHasAModelOfTheBudget) {
  const FitResult all = Fit(ByChannel(), Auto(250));
  FitOptions options = Auto(250);
  std::atomic<bool> solved = false;
  std::atomic<int> asked = 0;
  options.on_model = [&](const FitResult&) { solved = true; };
  options.stop = [&] { return solved && ++asked > 20; };
  const FitResult fit = Fit(ByChannel(), options);
  EXPECT_TRUE(fit.interrupted);
  ASSERT_FALSE(fit.finished.candidates.empty());
  EXPECT_LT(fit.finished.candidates.size(), all.finished.candidates.size());
  EXPECT_LE(fit.stored_parameters, 250);
  EXPECT_LT(fit.score.relative_objective, 0.1);
}

// A cloth, measured at too few pairs of nodes for a grid.
TEST(FitOfScattered, ChoosesAmongAnisotropicForms) {
  Measurement measured = LoadMeasurement("synth:linen@6x24");
  LeaveOutAtRandom(0.75, 1, &measured);
  ASSERT_TRUE(measured.anisotropic);
  measured.azimuths_matter = true;
  ASSERT_FALSE(GridOf(measured));
  FitOptions options = Auto(350);
  options.solver = "awls";
  options.solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions{.max_iterations = 3, .diagnose = false};
  };
  const FitResult fit = Fit(measured, options);
  const std::vector<Candidate>& candidates = fit.finished.candidates;
  const int chosen = fit.finished.chosen;
  ASSERT_GE(candidates.size(), 3U);
  const double samples = static_cast<double>(measured.samples.size());
  EXPECT_NEAR(fit.finished.held_out, samples / 5, samples / 20);
  for (const Candidate& candidate : candidates) {
    EXPECT_LE(candidate.num_parameters, 350) << candidate.name;
    EXPECT_TRUE(chosen == 0 || candidates[chosen].score >= candidate.score) << candidate.name;
  }
  EXPECT_EQ(fit.stored_parameters, candidates[chosen].num_parameters);
  EXPECT_EQ(fit.score.valid_samples, measured.samples.size());
  options.num_threads = 3;
  EXPECT_EQ(Parameters(fit), Parameters(Fit(measured, options)));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
