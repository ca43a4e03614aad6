#include "trilobe/fit/finish/synthetic_prior.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "model/objective/lobes.h"
#include "tests/error_of.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/model/measurement/tabulated_brdf.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr HemisphereGrid kGrid = {6, 16};

const SynthMaterial& Steel() { return FindSynthMaterial("aniso_ggx_steel"); }

BrdfSamples SteelAtNodes() { return SamplesOf(SynthesizeSamples(Steel(), 0, 1, kGrid)); }

ModelSpec Spec(int f_bins) {
  ModelSpec spec = ModelSpec::Anisotropic(2);
  spec.d_axis = Axis::Polar({0, 2, 6, 14, 25, 39, 55, 75}, 16);
  spec.f_axis.size = f_bins;
  spec.g_axis = Axis::Polar({0, 15, 30, 45, 60, 75}, 16);
  return spec;
}

// Relative, by the light that is reflected, halfway between the nodes.
double ErrorBetween(const FactorModel& model) {
  BrdfSamples between;
  std::vector<Rgb> wanted;
  constexpr int kNodes = 5 * 16;
  for (int i = 0; i < kNodes; ++i) {
    for (int o = 0; o < kNodes; ++o) {
      const SphericalAngles at = kGrid.Angles(i, o, 0.5);
      between.directions.push_back(at);
      between.angles.push_back(ToHalfDiff(ToDirections(at)));
      wanted.push_back(Steel().brdf(ToDirections(at)));
    }
  }
  between.rho.assign(wanted.size(), {});
  const std::vector<Rgb> fitted = EvaluateSamples(model, between, 2);
  double difference = 0, sum = 0;
  for (size_t k = 0; k < wanted.size(); ++k) {
    const double cosines =
        std::cos(between.directions[k].theta_i) * std::cos(between.directions[k].theta_o);
    difference += cosines * std::abs(fitted[k][1] - wanted[k][1]);
    sum += cosines * wanted[k][1];
  }
  return difference / sum;
}

double ErrorOfFit(const BrdfSamples& samples, int f_bins) {
  const Objective objective(samples, Spec(f_bins), Weightings().front(), 2);
  FactorModel model = FindInitialModel("moments").make(objective, 1);
  SolverOptions options;
  options.max_iterations = 40;
  options.diagnose = false;
  MakeSolver("varpro")->Solve(objective, options, &model);
  return ErrorBetween(model);
}

TEST(SyntheticPrior, AddsSamplesBetweenThoseOfTheData) {
  const BrdfSamples data = SteelAtNodes();
  const Objective one(data, Spec(6), Weightings().front(), 1);
  const Objective three(data, Spec(6), Weightings().front(), 3);
  const BrdfSamples both = WithPrior(one, {.weight = 0.25});
  CheckSamples(both);
  ASSERT_EQ(both.size(), data.size() + data.size() / 6);
  EXPECT_TRUE(std::equal(data.rho.begin(), data.rho.end(), both.rho.begin()));
  for (int j = 0; j < both.size(); ++j) {
    ASSERT_EQ(both.Multiplicity(j), j < data.size() ? 1 : 0.25);
    ASSERT_LE(both.directions[j].theta_o, DegreesToRadians(75) + 1e-9);
  }
  EXPECT_EQ(WithPrior(three, {.weight = 0.25}).rho, both.rho);
  EXPECT_THAT(ErrorOf([&] { WithPrior(one, {.weight = 0}); }),
              IsError(ErrorKind::kRange, {.key = "weight", .value = "0"}));
}

// A solver lowers E of data and prior together, and tells E of the data alone, from the start on.
TEST(SyntheticPrior, ObjectivesOfTheDataAreToldBesides) {
  const Objective data(SteelAtNodes(), Spec(6), Weightings().front(), 2);
  const Objective with_prior(data, WithPrior(data, {}));
  EXPECT_TRUE(with_prior.has_prior());
  EXPECT_FALSE(with_prior.data().has_prior());
  EXPECT_EQ(with_prior.weighting().level, data.weighting().level);
  EXPECT_EQ(&data.data(), &data);
  ModelSpec finer = Spec(18);
  EXPECT_EQ(Objective(with_prior, finer).data().MeasuredEnergy(), data.MeasuredEnergy());
  const FactorModel start = FindInitialModel("moments").make(data, 1);
  for (const char* const solver : {"varpro", "awls_block", "lm", "auto"}) {
    FactorModel model = start;
    SolverOptions options;
    options.max_iterations = 6;
    options.diagnose = false;
    options.on_iteration = [&](const IterationRecord& record, const FactorModel& current) {
      EXPECT_EQ(record.objective, data.Value(current)) << solver;
      EXPECT_NEAR(*record.objective_with_prior / with_prior.Value(current), 1, 1e-12) << solver;
      return true;
    };
    const SolverSummary summary = MakeSolver(solver)->Solve(with_prior, options, &model);
    EXPECT_EQ(summary.initial_objective, data.Value(start)) << solver;
    EXPECT_EQ(summary.final_objective, data.Value(model)) << solver;
    const IterationRecord& best = summary.trace[summary.BestIteration()];
    EXPECT_EQ(best.objective, summary.final_objective) << solver;
    EXPECT_NEAR(*best.objective_with_prior / with_prior.Value(model), 1, 1e-12) << solver;
    EXPECT_LT(*best.objective_with_prior, *summary.trace.front().objective_with_prior) << solver;
    EXPECT_THAT(summary.FullReport(), testing::HasSubstr("with the prior, which is what"))
        << solver;
    EXPECT_THAT(summary.BriefReport(), testing::HasSubstr(" (with the prior ")) << solver;
  }
}

// Factors that trade between neighbouring nodes fit these as well, and are wrong in between.
TEST(SyntheticPrior, KeepsAFitRightBetweenTheSamples) {
  const BrdfSamples data = SteelAtNodes();
  const Objective objective(data, Spec(6), Weightings().front(), 2);
  const double with_prior = ErrorOfFit(WithPrior(objective, {}), 6);
  EXPECT_LT(with_prior, 0.15);
  EXPECT_LT(2 * with_prior, ErrorOfFit(data, 90));
}

// Far fewer values than parameters: what they do not tell is the prior's, and it is no free guess.
TEST(SyntheticPrior, KeepsAFitOfFewScatteredSamplesTame) {
  constexpr int kFew = 250;
  const BrdfSamples all = SamplesOf(SynthesizeSamples(FindSynthMaterial("velvet"), 0, 1, kGrid));
  std::vector<int> numbers(all.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  std::mt19937 random(1);
  for (int j = 0; j < kFew; ++j) {
    std::swap(numbers[j], numbers[j + random() % (numbers.size() - j)]);
  }
  const std::vector<int> few(numbers.begin(), numbers.begin() + kFew);
  const std::vector<int> others(numbers.begin() + kFew, numbers.end());
  const BrdfSamples data = Selected(all, few), held_out = Selected(all, others);
  const ModelSpec spec = ModelSpec::AnisotropicFor(3, 16, DegreesToRadians(75));
  ASSERT_LT(3 * data.size(), spec.num_parameters());
  const Objective unseen(held_out, spec, Weightings().front());
  const auto error = [&](const BrdfSamples& samples) {
    const Objective objective(samples, spec, Weightings().front(), 2);
    FactorModel model = FindInitialModel("moments").make(objective, 1);
    SolverOptions options;
    options.max_iterations = 20;
    options.diagnose = false;
    MakeSolver("varpro")->Solve(objective, options, &model);
    return unseen.Value(model) / unseen.MeasuredEnergy();
  };
  const Objective objective(data, spec, Weightings().front(), 2);
  const BrdfSamples with_prior = WithPrior(objective, {});
  EXPECT_GE(with_prior.size() - data.size(), 6 * spec.num_parameters());
  double weight = 0;
  for (int j = data.size(); j < with_prior.size(); ++j) weight += with_prior.Multiplicity(j);
  EXPECT_NEAR(weight, data.size() / 6.0, 1e-9);
  const double with = error(with_prior), without = error(data);
  EXPECT_LT(with, 5);
  EXPECT_LT(1000 * with, without);
}

// 1,500 pairs of directions, as an older gonioreflectometer has them: 822 parameters fit them, and
// are anything between.
TEST(SyntheticPrior, KeepsAnIsotropicFitTameBetweenFewSamples) {
  const BrdfTable table = Synthesize(FindSynthMaterial("plastic"), 0, 1);
  const BrdfSamples all = ValidSamples(table);
  BrdfSamples data;
  data.source = "few";
  std::mt19937 random(1);
  const auto draw = [&](double upto) {
    return upto * static_cast<double>(random()) / 4294967296.0;
  };
  const TabulatedBrdf between(table);
  while (data.size() < 1500) {
    const SphericalAngles at{.theta_i = draw(1.4), .theta_o = draw(1.4), .phi_o = draw(2 * kPi)};
    const HalfDiffAngles angles = ToHalfDiff(ToDirections(at));
    data.directions.push_back(at);
    data.angles.push_back(angles);
    data.rho.push_back(between.Interpolate(angles));
  }
  const ModelSpec full = ModelSpec::SharedFactors(3), few = full.ForScattered(data.size());
  EXPECT_EQ(few.table_size(Factor::kF), 10);
  EXPECT_EQ(few.table_size(Factor::kG), 9);
  EXPECT_EQ(full.ForScattered(200 * full.num_parameters()), full);
  const Objective everywhere(Thinned(all, 20), full, FindWeighting("appearance"), 2);
  const auto error = [&](const BrdfSamples& samples, const ModelSpec& spec) {
    const Objective objective(samples, spec, FindWeighting("appearance"), 2);
    FactorModel model = FindInitialModel("analytic").make(objective, 1);
    SolverOptions options;
    options.max_iterations = 30;
    options.diagnose = false;
    MakeSolver("varpro")->Solve(objective, options, &model);
    return everywhere.Value(WithAxes(model, full)) / everywhere.MeasuredEnergy();
  };
  const BrdfSamples with_prior =
      WithPrior(Objective(data, few, FindWeighting("appearance")), {.isotropic = true});
  CheckSamples(with_prior);
  const double with = error(with_prior, few), without = error(data, full);
  EXPECT_LT(with, 0.1);
  EXPECT_LT(1000 * with, without);
}

// With noise of 30 % and a G near 0 where the data read an entry of D, that entry grows, and shines
// elsewhere.
TEST(SyntheticPrior, TamesAFitThatIsWildBetweenNoisySamples) {
  const BrdfTable table = Synthesize(FindSynthMaterial("copper"), 0, 1);
  const TabulatedBrdf between(table);
  std::mt19937 random(3);
  const auto draw = [&](double upto) {
    return upto * static_cast<double>(random()) / 4294967296.0;
  };
  constexpr double kMaxTheta = 0.5;
  BrdfSamples data, truth;
  data.source = truth.source = "noisy";
  const auto add = [&](double noise, BrdfSamples* samples) {
    const SphericalAngles at{
        .theta_i = draw(kMaxTheta), .theta_o = draw(kMaxTheta), .phi_o = draw(2 * kPi)};
    const HalfDiffAngles angles = ToHalfDiff(ToDirections(at));
    samples->directions.push_back(at);
    samples->angles.push_back(angles);
    Rgb rho = between.Interpolate(angles);
    for (double& x : rho) x *= std::exp(noise * (draw(1) + draw(1) + draw(1) + draw(1) - 2));
    samples->rho.push_back(rho);
  };
  while (data.size() < 200) add(0.5, &data);
  while (truth.size() < 2000) add(0, &truth);
  const ModelSpec spec = ModelSpec::SharedFactors(3).ForScattered(data.size());
  const Objective objective(data, spec, FindWeighting("appearance"), 2);
  const SyntheticPrior prior(objective, {.isotropic = true});
  Objective with_prior(objective, prior.JoinTo(objective));
  FactorModel model = FindInitialModel("analytic").make(objective, 1);
  SolverOptions options;
  options.max_iterations = 60;
  options.diagnose = false;
  MakeSolver("varpro")->Solve(with_prior, options, &model);
  const Objective right(truth, spec, FindWeighting("appearance"), 2);
  const FactorModel overshooting = model;
  ASSERT_GT(ReachOf(data, overshooting, 2).between, 4);
  const std::optional<CorrectedOvershoot> overshoot = CorrectOvershoot(
      prior, [] { return false; }, &with_prior, &model);
  ASSERT_TRUE(overshoot.has_value());
  EXPECT_EQ(overshoot->E_before, objective.Value(overshooting));
  EXPECT_EQ(overshoot->E_after, objective.Value(model));
  EXPECT_LT(overshoot->E_after, 1.1 * overshoot->E_before);
  EXPECT_LE(ReachOf(data, model, 2).between, 3);  // it looks at other directions, too
  EXPECT_EQ(ReachOf(data, model, 1).beyond, ReachOf(data, model, 3).beyond);
  EXPECT_LT(2 * right.Value(model), right.Value(overshooting));
  // Then there is nothing to do.
  const FactorModel corrected = model;
  EXPECT_FALSE(CorrectOvershoot(
                   prior, [] { return false; }, &with_prior, &model)
                   .has_value());
  EXPECT_TRUE(std::ranges::equal(model.parameters(), corrected.parameters()));
}

// Two kinds of threads reflect in shot silk, a coat and its base in lacquer; one of anything in
// steel.
TEST(SyntheticPrior, HasASecondLobeWhereOneLeavesMostOfE) {
  const auto lobes_of = [](const char* material, const HemisphereGrid& grid) {
    const Objective data(SamplesOf(SynthesizeSamples(FindSynthMaterial(material), 0, 1, grid)),
                         Spec(10), Weightings().front(), 2);
    return SyntheticPrior(data, {}).model().spec().lobes;
  };
  EXPECT_EQ(lobes_of("shot_silk", kGrid), 2);
  EXPECT_EQ(lobes_of("aniso_ggx_lacquer", kGrid), 2);
  EXPECT_EQ(lobes_of("aniso_ggx_steel", kGrid), 1);
  EXPECT_EQ(lobes_of("shot_silk", {4, 8}), 1) << "too few samples to tell";
}

TEST(SyntheticPrior, NeedsDirections) {
  BrdfSamples samples = SteelAtNodes();
  samples.directions.clear();
  const Objective objective(samples, ModelSpec::SharedFactors(1), Weightings().front());
  EXPECT_THAT(ErrorOf([&] { WithPrior(objective, {}); }),
              IsError(ErrorKind::kMissing, {.key = "directions"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
