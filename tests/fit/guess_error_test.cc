#include "fit/guess_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

const AppearanceOptions kSmall = {.lights = 100, .size = 48};

FitResult FitUpTo(double degrees, const Measurement& whole) {
  Measurement measured = whole;
  LimitAngles(DegreesToRadians(degrees), &measured);
  return Fit(measured, {.appearance = kSmall});
}

// The truth beyond the data is known for these materials.
TEST(GuessError, OfTheWholeIsWithinAFactorOfTheTruth) {
  const std::vector<std::string> names = {"synth:plastic@30x30x60", "synth:copper@30x30x60"};
  const std::vector<double> limits = {60, 72};
  for (const std::string& name : names) {
    for (const double& degrees : limits) {
      if (!IsOneIn(2, {NumberOf(name, names), NumberOf(degrees, limits)})) continue;
      const Measurement whole = LoadMeasurement(name);
      const FitResult fit = FitUpTo(degrees, whole);
      ASSERT_TRUE(fit.whole.has_value());
      const SphereError truth =
          SphereJudge::OfAllDirections(*whole.table, kSmall)(MaterialOf(fit.model()).angular);
      EXPECT_NEAR(std::log2(fit.whole->mean_delta_e / truth.mean_delta_e), 0, 1.3)
          << name << " up to " << degrees << ": " << fit.whole->mean_delta_e << " for "
          << truth.mean_delta_e;
      EXPECT_NEAR(fit.whole->psnr_db, truth.psnr_db, 9) << name << " up to " << degrees;
    }
  }
}

TEST(GuessError, IsOfWhatWasNotMeasured) {
  const Measurement whole = LoadMeasurement("synth:plastic@20x20x40");
  EXPECT_FALSE(Fit(whole, {.appearance = kSmall}).whole.has_value());
  const FitResult fit = FitUpTo(65, whole);
  const auto estimate = [&](double share, int threads) {
    AppearanceOptions options = kSmall;
    options.num_threads = threads;
    return EstimateWholeSphere(fit.objective, fit.model(), share, fit.appearance->sphere, options);
  };
  EXPECT_EQ(estimate(fit.measured_share, 1), fit.whole);
  EXPECT_EQ(estimate(fit.measured_share, 3), fit.whole);
  EXPECT_EQ(estimate(0.99, 1), std::nullopt);
  // A guess of more is worth less, and what was seen of the rest counts in full.
  EXPECT_GT(estimate(0.2, 1)->mean_delta_e, fit.whole->mean_delta_e);
  EXPECT_GT(fit.whole->mean_delta_e, fit.appearance->sphere.mean_delta_e);
  EXPECT_LT(fit.whole->psnr_db, fit.appearance->sphere.psnr_db);
}

// Samples of a table in the plane of incidence.
Measurement ScansOf(const BrdfTable& table, const std::vector<double>& incidences) {
  SampleCollector collector("scans", "test");
  const TabulatedBrdf brdf(table);
  for (const double theta_i : incidences) {
    for (int theta_o = -80; theta_o <= 80; theta_o += 4) {
      const SphericalAngles at = {DegreesToRadians(theta_i), 0, DegreesToRadians(std::abs(theta_o)),
                                  theta_o < 0 ? 0 : kPi};
      collector.Add(at, brdf(ToDirections(at)));
    }
  }
  return collector.Take();
}

TEST(GuessError, OfScansIsNearTheTruth) {
  const Measurement whole = LoadMeasurement("synth:plastic@30x30x60");
  const auto fit_to = [&](const std::vector<double>& incidences) {
    FitOptions options;
    options.appearance = kSmall;
    return Fit(ScansOf(*whole.table, incidences), options);
  };
  const FitResult fit = fit_to({10, 30, 50, 70});
  ASSERT_TRUE(fit.whole.has_value());
  const SphereError truth =
      SphereJudge::OfAllDirections(*whole.table, kSmall)(MaterialOf(fit.model()).angular);
  EXPECT_NEAR(std::log2(fit.whole->mean_delta_e / truth.mean_delta_e), 0, 1.3)
      << fit.whole->mean_delta_e << " for " << truth.mean_delta_e;
  EXPECT_NEAR(fit.whole->psnr_db, truth.psnr_db, 9);
  EXPECT_GT(fit.whole->mean_delta_e, fit.samples_seen->mean_delta_e);
  // One incidence cannot be halved.
  EXPECT_FALSE(fit_to({40}).whole.has_value());
}

TEST(GuessError, OfNodesIsNearTheTruth) {
  FitOptions options;
  options.appearance = kSmall;
  options.solver = "awls";
  options.solver_options = [](const ModelSpec&) {
    SolverOptions solver;
    solver.max_iterations = 5;
    return solver;
  };
  for (const char* name : {"synth:rolled_brass@6x24", "synth:velvet@6x24"}) {
    const FitResult fit = Fit(LoadMeasurement(name), options);
    ASSERT_TRUE(fit.whole.has_value());
    const SphereError& truth = fit.appearance->from_formula->whole;
    EXPECT_NEAR(std::log2(fit.whole->mean_delta_e / truth.mean_delta_e), 0, 1.3)
        << name << ": " << fit.whole->mean_delta_e << " for " << truth.mean_delta_e;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
