// awls_gss: what it does beyond what every solver does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};

// A table read linearly between its nodes, at a place where the spline is.
struct Linear {
  int k;
  double t;

  Linear(const CatmullRom& spline, double theta)
      : k(spline.Locate(theta).interval), t(spline.Locate(theta).t) {}
  double operator()(std::span<const double> table) const {
    return (1 - t) * table[k] + t * table[k + 1];
  }
  double Weight(int node) const { return node == k ? 1 - t : node == k + 1 ? t : 0; }
};

// A table of G of one channel, each node in turn where E is lowest as G(theta_i) or, if `o`, as
// G(theta_o), with the other held; E as the sum over all samples, literally.
std::vector<double> Swept(const Objective& objective, const FactorModel& model, int c, bool o) {
  const int nodes = model.spec().g_axis.size;
  const CatmullRom spline(nodes);
  std::vector<double> cosines(nodes);
  for (int k = 0; k < nodes; ++k) cosines[k] = std::cos(spline.NodeAngle(k));
  const std::span<const double> held = model.G(0, c);
  std::vector<double> moving(held.begin(), held.end());
  const BrdfSamples& samples = objective.samples();
  for (int k = 0; k < nodes; ++k) {
    double above = 0, below = 0;
    for (int j = 0; j < samples.size(); ++j) {
      const Cosines at = ToCosines(samples.Angles(j));
      const WeightedSample sample = objective.Sample(j);
      Linear mine(spline, std::acos(at.i)), other(spline, std::acos(at.o));
      if (o) std::swap(mine, other);
      const double y = model.s(0)[c] * sample.stencils.D(model.D(0, c)) *
                       sample.stencils.F(model.F(0, c)) * other(held) /
                       (mine(cosines) * other(cosines));
      const double residual = sample.rho[c] - model.d()[c] - y * mine(moving);
      const double p = y * mine.Weight(k);
      above += sample.weight[c] * residual * p;
      below += sample.weight[c] * p * p;
    }
    if (below > 0) moving[k] = std::max(0.0, moving[k] + above / below);
  }
  return moving;
}

TEST(AwlsGss, MovesGToTheMeanOfBothReadings) {
  const ModelSpec spec = ModelSpec::IndependentG(kGrid);
  const Objective objective =
      MakeObjective(TableOf(RandomModel(spec, 1), kGrid), spec, "appearance");
  FactorModel model = RandomModel(spec, 2);
  FactorModel before, after;
  SolverOptions options;
  options.max_iterations = 1;
  options.diagnose = false;
  options.on_element = [&](const FactorModel& now) {
    before = after;
    after = now;
  };
  MakeSolver("awls_gss")->Solve(objective, options, &model);
  FactorModel full = before;
  for (int c = 0; c < kChannels; ++c) {
    const std::vector<double> as_i = Swept(objective, before, c, false);
    const std::vector<double> as_o = Swept(objective, before, c, true);
    for (size_t k = 0; k < as_i.size(); ++k) {
      full.table(Factor::kG, c)[k] = (as_i[k] + as_o[k]) / 2;
    }
  }
  ASSERT_LT(objective.Value(full), objective.Value(before));  // so it goes all the way
  for (size_t k = 0; k < full.parameters().size(); ++k) {
    EXPECT_NEAR(after.parameters()[k], full.parameters()[k], 1e-9 * (1 + full.parameters()[k]))
        << k;
  }
}

TEST(AwlsGss, IsAwlsInAllButG) {
  const ModelSpec spec = ModelSpec::SharedFactors(3, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  const int before_g = FactorModel(spec).TableOffset(Factor::kG, 0);
  std::vector<FactorModel> seen[2];
  for (const bool gss : {false, true}) {
    FactorModel model = RandomModel(spec, 2);
    SolverOptions options;
    options.max_iterations = 1;
    options.on_element = [&](const FactorModel& now) { seen[gss].push_back(now); };
    MakeSolver(gss ? "awls_gss" : "awls")->Solve(objective, options, &model);
  }
  ASSERT_EQ(static_cast<int>(seen[1].size()), before_g + 1);
  for (int k = 0; k < before_g; ++k) {
    EXPECT_TRUE(std::ranges::equal(seen[0][k].parameters(), seen[1][k].parameters())) << k;
  }
}

// G is rough in truth, so that smoothing it does harm: awls with the filter raises E here.
TEST(AwlsGss, TheFilterDoesNotRaiseE) {
  const FactorModel truth = RandomModel(ModelSpec::SharedFactors(3, kGrid), 2);
  const Objective objective = MakeObjective(TableOf(truth, kGrid), truth.spec());
  FactorModel model = truth;
  for (double& s : model.s(0)) s *= 1.01;
  SolverOptions options;
  options.max_iterations = 5;
  options.g_filter_sigma = 1;
  const SolverSummary summary = MakeSolver("awls_gss")->Solve(objective, options, &model);
  for (size_t k = 1; k < summary.trace.size(); ++k) {
    EXPECT_LE(summary.trace[k].objective, summary.trace[k - 1].objective * (1 + 1e-12));
    EXPECT_FALSE(summary.trace[k].filtered);
  }
  EXPECT_LT(summary.final_objective, 0.1 * summary.initial_objective);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
