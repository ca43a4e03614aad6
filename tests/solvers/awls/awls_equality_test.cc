// The fast solver makes the same element updates as the reference: E after each of 20 sweeps
// agrees to 1e-9.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

SolverOptions Sweeps(int count, double g_filter_sigma = 0) {
  SolverOptions options;
  options.max_iterations = count;
  options.g_filter_sigma = g_filter_sigma;
  options.relative_decrease_tolerance = -std::numeric_limits<double>::infinity();  // never
  return options;
}

void ExpectSameSweeps(const Objective& objective, const FactorModel& start,
                      const SolverOptions& options, const std::string& what) {
  FactorModel fast = start, reference = start;
  const SolverSummary fast_run = MakeSolver("awls")->Solve(objective, options, &fast);
  const SolverSummary reference_run =
      MakeSolver("awls_literal")->Solve(objective, options, &reference);
  ASSERT_EQ(reference_run.iterations, options.max_iterations) << what;
  ASSERT_EQ(fast_run.trace.size(), reference_run.trace.size()) << what;
  for (size_t k = 0; k < fast_run.trace.size(); ++k) {
    const double expected = reference_run.trace[k].objective;
    ASSERT_NEAR(fast_run.trace[k].objective, expected, 1e-9 * expected) << what << ", sweep " << k;
  }
  // The fit has moved, or agreement would mean nothing.
  if (start.spec().lobes > 0) {
    const double first = reference_run.trace.front().objective;
    const double last = reference_run.trace.back().objective;
    if (options.g_filter_sigma > 0) {  // the filter may raise E, and does on thin data
      EXPECT_GT(std::abs(last - first), 0.01 * first) << what;
    } else {
      EXPECT_LT(last, 0.99 * first) << what;
    }
  }
  // Parameters too, to a share of their table's largest: small ones may be poorly determined.
  const auto expect_same = [&](std::span<const double> a, std::span<const double> b,
                               const std::string& part) {
    const double scale = std::ranges::max(b);
    for (size_t k = 0; k < a.size(); ++k) {
      ASSERT_NEAR(a[k], b[k], 1e-6 * scale) << what << ", " << part << " " << k;
    }
  };
  const ModelSpec& spec = start.spec();
  expect_same(fast.d(), reference.d(), "d");
  for (int m = 0; m < spec.lobes; ++m) expect_same(fast.s(m), reference.s(m), "s");
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      expect_same(fast.table(factor, t), reference.table(factor, t), FactorName(factor));
    }
  }
}

// Samples that are on no grid, of which each reads entries of D and F between bins.
BrdfSamples BetweenBins(const MerlGrid& grid, uint64_t seed) {
  BrdfSamples samples = Scattered(ValidSamples(RandomTable(grid, seed)));
  Random random(seed);
  for (HalfDiffAngles& at : samples.angles) {
    at.theta_h *= random.Uniform(0.5, 1);
    at.theta_d *= random.Uniform(0.5, 1);
  }
  return samples;
}

TEST(AwlsEquality, ScatteredSamples) {
  constexpr MerlGrid kGrid{7, 9, 12};
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    for (const char* const weighting : {"appearance", "uniform"}) {
      const Objective objective(BetweenBins(kGrid, 4), spec, FindWeighting(weighting));
      ASSERT_EQ(objective.folded(), nullptr);
      const FactorModel start = FindInitialModel("random").make(objective, 3);
      ASSERT_NO_FATAL_FAILURE(
          ExpectSameSweeps(objective, start, Sweeps(20), name + ", " + weighting));
    }
  }
}

// All sharings, all weightings, half pairs and missing rows, an odd number of phi_d bins.
TEST(AwlsEquality, AnySpecAndWeighting) {
  for (const MerlGrid& grid : {MerlGrid{8, 10, 12}, MerlGrid{7, 9, 13}}) {
    const bool odd = grid.phi_d % 2 == 1;
    const BrdfTable table = Synthesize(FindSynthMaterial(odd ? "felt" : "plastic"), 0.1, 1, grid);
    const std::vector<NamedSpec> specs = TestSpecs(grid);
    for (const NamedSpec& named : specs) {
      for (const Weighting& weighting : Weightings()) {
        // Each spec and each weighting on both grids.
        if (!IsOneIn(4, {odd, NumberOf(named, specs), NumberOf(weighting, Weightings())})) continue;
        if (kSanitized && (weighting.name == "log" || weighting.name == "cosine")) continue;
        const Objective objective = MakeObjective(table, named.spec, weighting.name);
        const FactorModel start = FindInitialModel("random").make(objective, 3);
        ASSERT_NO_FATAL_FAILURE(
            ExpectSameSweeps(objective, start, Sweeps(20), named.name + ", " + weighting.name));
      }
    }
  }
}

TEST(AwlsEquality, AnySplineResolution) {
  constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 10, .phi_d = 12};
  const BrdfTable table = Synthesize(FindSynthMaterial("aluminium"), 0.1, 1, kGrid);
  for (const int nodes : {4, 5, 23}) {
    ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
    spec.g_axis.size = nodes;
    const Objective objective = MakeObjective(table, spec);
    const FactorModel start = FindInitialModel("analytic").make(objective, 1);
    ExpectSameSweeps(objective, start, Sweeps(20), std::to_string(nodes) + " nodes");
  }
}

// Keeps about 1 in `thinning` mirror pairs of a full-size measurement, and of every third of these
// one half only.
BrdfTable Thinned(BrdfTable table, uint64_t thinning) {
  const MerlGrid& grid = table.grid;
  for (int bin = 0; bin < grid.size(); ++bin) {
    const int p = bin % grid.phi_d, row = bin / grid.phi_d;
    const int mirror = grid.phi_d - 1 - p;
    const uint64_t pair = static_cast<uint64_t>(row) * grid.phi_d + std::min(p, mirror);
    const uint64_t hash = (pair * 0x9e3779b97f4a7c15U) >> 20;
    const bool kept = hash % thinning == 0;
    const bool half = hash / thinning % 3 == 0;
    if (!kept || (half && p < mirror)) table.stored[0][bin] = -1;
  }
  return table;
}

class FullResolution : public testing::TestWithParam<const char*> {};

TEST_P(FullResolution, EqualOver20Sweeps) {
  const BrdfTable table = Thinned(Synthesize(FindSynthMaterial(GetParam()), 0.1, 1), 200);
  const Objective objective = MakeObjective(table, ModelSpec::SharedFactors(3));
  const FactorModel start = InitialModels().front().make(objective, 1);
  for (const double sigma : {0.0, 1.0}) {
    const std::string what = std::string(GetParam()) + ", filter " + std::to_string(sigma);
    ExpectSameSweeps(objective, start, Sweeps(20, sigma), what);
  }
}

INSTANTIATE_TEST_SUITE_P(AwlsEquality, FullResolution, testing::Values("plastic", "felt", "chrome"),
                         [](const auto& param) { return param.param; });

// Every bin of a MERL file, one sweep each way; by day of a file with half as many along each axis.
TEST(AwlsEquality, FullSizeSweep) {
  const std::vector<MerlGrid> grids = {{.theta_h = 45, .theta_d = 45, .phi_d = 90}, {}};
  for (const MerlGrid& grid : grids) {
    if (!IsOneIn(2, {NumberOf(grid, grids)})) continue;
    const BrdfTable table = Synthesize(FindSynthMaterial("car-paint"), 0.02, 1, grid);
    const Objective objective = MakeObjective(table, ModelSpec::SharedFactors(3, grid));
    const FactorModel start = InitialModels().front().make(objective, 1);
    ExpectSameSweeps(objective, start, Sweeps(1), "car-paint");
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
