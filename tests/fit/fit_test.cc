#include "trilobe/fit/fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "fit/held_out.h"
#include "tests/error_of.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Quick, but through all steps.
FitOptions Quick() {
  FitOptions options;
  options.solver = "awls";
  options.solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions{.max_iterations = 3, .diagnose = false};
  };
  options.compare = false;
  return options;
}

std::vector<double> Parameters(const FitResult& fit) {
  return {fit.model().parameters().begin(), fit.model().parameters().end()};
}

TEST(Fit, TellsOfItsModelAndHowFarItIs) {
  const Measurement measured = LoadMeasurement("synth:plastic@20x20x40");
  FitOptions options = Quick();
  int begun = 0, steps = 0;
  std::vector<double> objectives;
  options.on_begin = [&] { ++begun; };
  options.on_iteration = [&](const IterationRecord&, const FactorModel&) { ++steps; };
  options.on_model = [&](const FitResult& fit) {
    EXPECT_EQ(fit.file.unobserved.size(), fit.model().parameters().size());
    objectives.push_back(fit.file.fit.objective);
  };
  const FitResult fit = Fit(measured, options);
  EXPECT_EQ(begun, 1);
  EXPECT_EQ(steps, 4);
  EXPECT_THAT(objectives, testing::ElementsAre(fit.summary.final_objective, fit.score.objective));
  EXPECT_EQ(fit.model().spec(), ModelSpec::SharedFactors(3, measured.table->grid));
  EXPECT_EQ(fit.score.objective, fit.objective.Value(fit.model()));
  EXPECT_FALSE(fit.appearance);
  // Functions that are empty are none.
  options = Quick();
  options.on_begin = nullptr;
  options.on_progress = nullptr;
  options.on_iteration = nullptr;
  options.on_model = nullptr;
  options.stop = nullptr;
  EXPECT_EQ(Parameters(fit), Parameters(Fit(measured, options)));
}

TEST(Fit, IsHeldAgainstSamplesThatItHasNotSeen) {
  const Measurement measured = LoadMeasurement("synth:plastic@12x12x24", {.noise = 0.1});
  FitOptions options = Quick();
  options.raw = true;
  const FitResult all = Fit(measured, options);
  EXPECT_FALSE(all.held_out);
  options.held_out = 1;
  const FitResult fit = Fit(measured, options);
  ASSERT_TRUE(fit.held_out);
  EXPECT_EQ(Parameters(fit), Parameters(all));  // is of all samples as before

  // The same by hand: a fit to the remaining samples is compared at those left out.
  const BrdfSamples samples = SamplesOf(measured);
  const HeldOutPart part(samples, 1, 1);
  options.held_out.reset();
  options.select = [&](const BrdfSamples& whole) { return part.RemoveFrom(whole); };
  const FactorModel model = Fit(measured, options).model();
  const Objective held(part.samples(), model.spec(), options.weighting);
  EXPECT_EQ(fit.held_out->samples, part.size());
  EXPECT_NEAR(fit.held_out->objective, held.Value(model), 1e-12 * held.Value(model));
  EXPECT_NEAR(fit.held_out->relative_objective, held.Value(model) / held.MeasuredEnergy(), 1e-12);
  EXPECT_GT(fit.held_out->mean_delta_e, 0);
}

TEST(Fit, ChoosesAFormWithoutTheHeldOutSamples) {
  const Measurement measured = LoadMeasurement("synth:copper@20x20x40", {.noise = 0.05});
  FitOptions options = Quick();
  options.choose_form = true;
  options.held_out = options.seed;
  options.max_parameters = 200;
  const FitResult fit = Fit(measured, options);
  ASSERT_TRUE(fit.held_out);
  EXPECT_LT(fit.held_out->relative_objective, 1);
}

TEST(Fit, HoldsNothingOutOfTooFewSamples) {
  Measurement measured = LoadMeasurement("synth:plastic@12x12x24");
  FitOptions options = Quick();
  options.held_out = 1;
  options.select = [](const BrdfSamples& all) { return Selected(all, {5, 6}); };
  EXPECT_FALSE(Fit(measured, options).held_out);
}

TEST(Fit, HasFinerNodesWhereTheDefaultLeavesAnError) {
  FitOptions options = Quick();
  options.solver = Solvers().front().name;
  options.form.lobes = 1;
  options.compare = false;
  const Measurement satin = LoadMeasurement("synth:charmeuse@6x24");
  const FitResult fit = Fit(satin, options);
  ASSERT_TRUE(fit.nodes);
  EXPECT_GT(fit.nodes->chosen, 0);
  EXPECT_EQ(fit.model().spec(), fit.nodes->model.spec());
  EXPECT_GT(fit.model().spec().num_parameters(), fit.nodes->tried.front().num_parameters);
  // These are the nodes that are asked for.
  options.form.d_nodes = fit.nodes->model.spec().d_axis;
  options.form.g_nodes = fit.nodes->model.spec().g_axis;
  EXPECT_EQ(Parameters(fit), Parameters(Fit(satin, options)));
  EXPECT_FALSE(Fit(satin, options).nodes);
  // Raw fits and those of little error have the default.
  options.form = {.lobes = 1};
  options.raw = true;
  EXPECT_FALSE(Fit(satin, options).nodes);
  options.raw = false;
  EXPECT_FALSE(Fit(LoadMeasurement("synth:enamelled_metal@6x24"), options).nodes);
}

// The solver has converged, so that smoothing can only raise E.
TEST(Fit, IsAsSmoothAsAsked) {
  const Measurement measured = LoadMeasurement("synth:plastic@20x20x40");
  FitOptions options = Quick();
  options.solver = "varpro";
  options.solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions{.diagnose = false};
  };
  options.match_reflectance = false;
  options.smoothness = 0;
  const FitResult least = Fit(measured, options);
  EXPECT_THAT(least.finished.steps, testing::IsEmpty());
  options.smoothness = 0.01;
  const FitResult smooth = Fit(measured, options);
  ASSERT_EQ(smooth.finished.steps.size(), 1U);
  const FinishingStep& step = smooth.finished.steps[0];
  EXPECT_EQ(step.name, "smoothness");
  EXPECT_NEAR(step.objective_before, least.score.objective, 1e-9 * least.score.objective);
  EXPECT_LE(step.objective_after, 1.01 * step.objective_before);
  EXPECT_EQ(step.objective_after, smooth.score.objective);
}

// A raw fit reports the solver's own results: the E of its trace, and a model that nothing else has
// changed.
TEST(Fit, RawIsWhatTheSolverFound) {
  // The data have an edge, at which joint steps would tie entries.
  const Measurement measured =
      LoadMeasurement("synth:copper@20x20x40", {.noise = 0.02, .max_angle_deg = 60});
  for (const SolverEntry& solver : Solvers()) {
    FitOptions options = Quick();
    options.solver = solver.name;
    options.raw = true;
    const FitResult fit = Fit(measured, options);
    EXPECT_THAT(fit.finished.steps, testing::IsEmpty()) << solver.name;
    const double E = fit.summary.trace[fit.summary.BestIteration()].objective;
    EXPECT_EQ(fit.summary.final_objective, E) << solver.name;
    EXPECT_EQ(fit.file.fit.solver_objective, E) << solver.name;
    EXPECT_NEAR(fit.score.objective, E, 1e-12 * E) << solver.name;
  }
}

TEST(Fit, RawAwlsIsLiteralAwlsAfterEachSweep) {
  const Measurement measured =
      LoadMeasurement("synth:copper@20x20x40", {.noise = 0.02, .max_angle_deg = 60});
  for (const int sweeps : {1, 4}) {
    FitOptions options = Quick();
    options.raw = true;
    options.solver_options = [sweeps](const ModelSpec& /*spec*/) {
      return SolverOptions{.max_iterations = sweeps, .diagnose = false};
    };
    options.solver = "awls";
    const FitResult fast = Fit(measured, options);
    options.solver = "awls_literal";
    const FitResult literal = Fit(measured, options);
    EXPECT_EQ(fast.summary.iterations, sweeps);
    EXPECT_NEAR(fast.score.objective, literal.score.objective, 1e-9 * literal.score.objective);
    const std::vector<double> expected = Parameters(literal), made = Parameters(fast);
    for (size_t k = 0; k < expected.size(); ++k) {
      EXPECT_NEAR(made[k], expected[k], 1e-6 * (1e-3 + expected[k])) << sweeps << ' ' << k;
    }
  }
}

// Only the default solver is followed by joint steps, which tie entries at the edge of the data.
TEST(Fit, TiesTheDataEdgeAfterTheDefaultSolver) {
  const Measurement measured =
      LoadMeasurement("synth:copper@20x20x40", {.noise = 0.02, .max_angle_deg = 60});
  const auto names = [&](const std::string& solver) {
    FitOptions options = Quick();
    options.solver = solver;
    std::vector<std::string> names;
    for (const FinishingStep& step : Fit(measured, options).finished.steps)
      names.push_back(step.name);
    return names;
  };
  EXPECT_THAT(names("auto"), testing::Contains("data_edge"));
  EXPECT_THAT(names("awls"), testing::Not(testing::Contains("data_edge")));
}

TEST(Fit, ChecksItsOptions) {
  const Measurement measured = LoadMeasurement("synth:plastic@20x20x40");
  FitOptions options = Quick();
  options.robust = std::nan("");
  EXPECT_THAT(ErrorOf([&] { Fit(measured, options); }),
              IsError(ErrorKind::kRange, {.key = "robust", .value = "nan"}));
  for (const bool robust : {false, true}) {
    options = Quick();
    options.raw = true;
    options.robust = robust ? 0.1 : 0;
    options.choose_form = !robust;
    EXPECT_THAT(ErrorOf([&] { Fit(measured, options); }),
                IsError(ErrorKind::kConflict, {.key = robust ? "robust" : "model"}));
  }
  options = Quick();
  options.choose_form = true;
  options.max_parameters = 0;
  EXPECT_THAT(ErrorOf([&] { Fit(measured, options); }),
              IsError(ErrorKind::kRange, {.key = "max_parameters", .value = "0"}));
  options = Quick();
  options.num_threads = -1;
  EXPECT_THAT(ErrorOf([&] { Fit(measured, options); }),
              IsError(ErrorKind::kRange, {.key = "num_threads", .value = "-1"}));
}

TEST(Fit, StopsBeforeItBeginsAndWithTheBestSoFar) {
  const Measurement measured = LoadMeasurement("synth:plastic@20x20x40");
  FitOptions options = Quick();
  options.on_begin = [] { ADD_FAILURE() << "there is nothing to begin with"; };
  options.stop = [] { return true; };
  EXPECT_TRUE(Fit(measured, options).interrupted);
  bool stop = false;
  int models = 0;
  options.on_begin = [] {};
  options.on_iteration = [&](const IterationRecord& record, const FactorModel&) {
    stop = record.iteration == 1;
  };
  options.on_model = [&](const FitResult&) { ++models; };
  options.stop = [&] { return stop; };
  const FitResult fit = Fit(measured, options);
  EXPECT_TRUE(fit.interrupted);
  EXPECT_EQ(models, 1);  // the finished one, which is not as the solver left it
  EXPECT_EQ(fit.summary.stop_reason, StopReason::kInterrupted);
  EXPECT_GT(fit.score.objective, 0);
}

TEST(Fit, RefusesWhatTheMeasurementCannotHave) {
  const Measurement table = LoadMeasurement("synth:plastic@20x20x40");
  const auto error = [](const Measurement& measured, const FitOptions& options) {
    return ErrorOf([&] { Fit(measured, options); });
  };
  FitOptions options = Quick();
  options.prior = 2;
  EXPECT_THAT(error(table, options), IsError(ErrorKind::kUnsupported, {.key = "prior"}));
  options = Quick();
  options.form.kind = FormOptions::Kind::kAnisotropic;
  EXPECT_THAT(error(table, options), IsError(ErrorKind::kUnsupported, {.key = "anisotropic"}));
  options = Quick();
  options.choose_form = true;
  options.max_parameters = 40;
  EXPECT_THAT(error(LoadMeasurement("synth:velvet@4x12"), options),
              IsError(ErrorKind::kRange, {.key = "max_parameters", .value = "40"}));
  options.start_model = FactorModel(ModelSpec::AnisotropicFor(1, 12, 1));
  EXPECT_THAT(error(LoadMeasurement("synth:velvet@4x12"), options),
              IsError(ErrorKind::kConflict, {.key = "start_model"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
