#include "fit/prune/prune_anisotropic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "model/objective/lobes.h"
#include "tests/error_of.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

ModelSpec Spec(int lobes, int phis) {
  ModelSpec spec = ModelSpec::Anisotropic(lobes);
  spec.d_axis = Axis::EvenPolar(5, Axis::Steps::kOfRoot, phis);
  spec.f_axis.size = 6;
  spec.g_axis = Axis::EvenPolar(3, Axis::Steps::kOfTheta, 4);
  return spec;
}

// Highlights along x or, of the second lobe, along y; `ratio` times as long as wide.
FactorModel Material(int lobes, int phis, double ratio) {
  FactorModel model(Spec(lobes, phis));
  const ModelSpec& spec = model.spec();
  for (int c = 0; c < kChannels; ++c) {
    model.d()[c] = 0.1 + 0.05 * c;
    for (int k = 0; k < spec.f_axis.size; ++k) {
      model.table(Factor::kF, c)[k] = 0.2 + 0.1 * c + std::pow((k + 0.5) / 6, 4);
    }
  }
  for (int m = 0; m < lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) model.s(m)[c] = 1 + m;
    for (int k = 0; k < spec.d_axis.size; ++k) {
      const double t = std::tan(spec.d_axis.Theta(k)), phi = spec.d_axis.Phi(k) + m * kPi / 2;
      const double x = t * std::cos(phi) / (0.3 * ratio), y = t * std::sin(phi) / 0.3;
      model.table(Factor::kD, m)[k] = std::exp(-(x * x + y * y) / (1 + m));
    }
    for (int k = 0; k < spec.g_axis.size; ++k) {
      model.table(Factor::kG, m)[k] = std::cos(spec.g_axis.Theta(k) * (0.3 + 0.5 * m));
    }
  }
  return model;
}

BrdfSamples SamplesOfModel(const FactorModel& model) {
  constexpr HemisphereGrid kGrid = {.thetas = 6, .phis = 16};
  BrdfSamples samples;
  samples.source = "model";
  for (int i = 0; i < kGrid.nodes(); ++i) {
    for (int o = i % 3; o < kGrid.nodes(); o += 3) {
      samples.directions.push_back(kGrid.Angles(i, o));
      samples.angles.push_back(ToHalfDiff(ToDirections(samples.directions.back())));
    }
  }
  samples.rho.assign(samples.directions.size(), {});
  samples.rho = EvaluateSamples(model, samples, 2);
  return samples;
}

// Multiplies samples by a wiggle that no model has, so that E is not 0.
BrdfSamples Uneven(BrdfSamples samples) {
  for (size_t j = 0; j < samples.rho.size(); ++j) {
    for (double& x : samples.rho[j]) x *= 1 + 0.03 * std::sin(static_cast<double>(7 * j));
  }
  return samples;
}

FactorModel Fit(const Objective& objective, FactorModel model) {
  SolverOptions options;
  options.max_iterations = 25;
  options.diagnose = false;
  MakeSolver("varpro")->Solve(objective, options, &model);
  return model;
}

struct Pruned {
  double E_full;
  PrunedModel model;
};

// Prunes a fit of the material that begins at `start`, two lobes on 16 phi.
Pruned PruneFitOf(const FactorModel& material, const FactorModel& start,
                  const PruneOptions& options, int threads = 2) {
  const Objective objective(Uneven(SamplesOfModel(material)), start.spec(), Weightings().front(),
                            threads);
  const FactorModel full = Fit(objective, start);
  return {objective.Value(full), PruneAnisotropic(objective, objective, full, options)};
}

bool Took(const PrunedModel& pruned, const std::string& what) {
  return std::ranges::any_of(pruned.decisions, [&](const PruneDecision& decision) {
    return decision.taken && decision.what.find(what) != std::string::npos;
  });
}

TEST(PruneAnisotropic, LeavesOutPhiThatAreNotNeeded) {
  const FactorModel material = Material(2, 8, 3);
  const FactorModel start = WithAxes(material, Spec(2, 16));
  const Pruned pruned = PruneFitOf(material, start, {.max_relative_rise = 0.2});
  const ModelSpec& spec = pruned.model.model.spec();
  EXPECT_TRUE(spec.anisotropic());
  EXPECT_EQ(spec.lobes, 2);
  EXPECT_LT(spec.d_axis.phi_nodes, 16);
  EXPECT_LT(pruned.model.num_parameters, start.spec().num_parameters());
  EXPECT_EQ(pruned.model.num_parameters, spec.num_parameters());
  EXPECT_LE(pruned.model.E, 1.2 * pruned.E_full * (1 + 1e-12));
  EXPECT_FALSE(Took(pruned.model, "isotropic instead"));
}

// Rings that no sample reads are not what G needs least: without them rims are wrong.
TEST(PruneAnisotropic, KeepsTheRingsTowardsTheHorizon) {
  const FactorModel material = Material(1, 8, 3);
  ModelSpec spec = material.spec();
  spec.g_axis = Axis::EvenPolar(6, Axis::Steps::kOfTheta, 4).ToHorizon();
  const Pruned pruned = PruneFitOf(material, WithAxes(material, spec),
                                   {.max_relative_rise = 0.5, .lobes = false, .tables = false});
  const Axis& axis = pruned.model.model.spec().g_axis;
  EXPECT_LT(axis.theta.size(), spec.g_axis.theta.size());
  EXPECT_TRUE(axis.reaches_horizon());
  EXPECT_EQ(axis.WithoutHorizon().theta.back(), 75);
  EXPECT_EQ(axis.WithoutHorizon().ToHorizon(), axis);
}

TEST(PruneAnisotropic, LeavesOutALobeAndAzimuthsThatDoNothing) {
  FactorModel material = Material(2, 8, 1);  // round: as wide as long
  for (double& s : material.s(1)) s = 0;
  const Pruned pruned =
      PruneFitOf(material, WithAxes(Material(2, 8, 1), Spec(2, 16)), {.max_relative_rise = 0.5});
  EXPECT_TRUE(Took(pruned.model, "isotropic instead of anisotropic"));
  EXPECT_FALSE(pruned.model.model.spec().anisotropic());
  EXPECT_EQ(pruned.model.model.spec().lobes, 1);
  EXPECT_LT(pruned.model.num_parameters, 200);
  EXPECT_LE(pruned.model.E, 1.5 * pruned.E_full * (1 + 1e-12));
}

TEST(PruneAnisotropic, MeetsABudgetOfParameters) {
  const FactorModel material = Material(2, 8, 3);
  const FactorModel start = WithAxes(material, Spec(2, 16));
  const Pruned pruned = PruneFitOf(material, start, {.max_parameters = 100});
  EXPECT_LE(pruned.model.num_parameters, 100);
  EXPECT_TRUE(pruned.model.model.spec().anisotropic());
  // Nothing may go.
  const Pruned none = PruneFitOf(material, start,
                                 {.max_parameters = 100,
                                  .lobes = false,
                                  .colour = false,
                                  .shadowing = false,
                                  .tables = false});
  EXPECT_EQ(none.model.model.spec(), start.spec());
  EXPECT_THAT(none.model.decisions.back().why, HasSubstr("does not reach the budget"));
}

TEST(PruneAnisotropic, WithoutABudgetNothingMoves) {
  const FactorModel material = Material(2, 8, 3);
  const FactorModel start = WithAxes(material, Spec(2, 16));
  const Pruned none = PruneFitOf(material, start, {.max_relative_rise = 0});
  EXPECT_EQ(none.model.model.spec(), start.spec());
  EXPECT_NEAR(none.model.E, none.E_full, 1e-12 * none.E_full);
  const Pruned less = PruneFitOf(material, start, {.max_relative_rise = -0.5});
  EXPECT_TRUE(less.model.misses_budget);
  EXPECT_LE(less.model.E, 1.1 * less.E_full);
  EXPECT_THAT(less.model.decisions.front().why, HasSubstr("none was found"));
  EXPECT_THAT(ErrorOf([&] { PruneFitOf(material, start, {.max_relative_rise = std::nan("")}); }),
              IsError(ErrorKind::kRange, {.key = "budget"}));
}

TEST(PruneAnisotropic, IsTheSameForAnyNumberOfThreads) {
  const FactorModel material = Material(2, 8, 3);
  const FactorModel start = WithAxes(material, Spec(2, 16));
  const PruneOptions options = {.max_relative_rise = 0.2};
  const Pruned one = PruneFitOf(material, start, options, 1);
  const Pruned three = PruneFitOf(material, start, options, 3);
  EXPECT_TRUE(std::ranges::equal(one.model.model.parameters(), three.model.model.parameters()));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
