#include "fit/finish/dim_highlights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/fit/fit.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// A mirror-like scan in the plane, from few incidences: a highlight narrower than its steps.
Measurement Scan() {
  Measurement scan{.source = "scan", .kind = "scattered samples"};
  for (const double theta_i : {5.0, 41.4, 60.0, 75.0}) {
    for (int theta_o = -89; theta_o < 90; ++theta_o) {
      const SphericalAngles at = {DegreesToRadians(theta_i), 0, DegreesToRadians(std::abs(theta_o)),
                                  theta_o < 0 ? 0 : kPi};
      const double off = std::sin(DegreesToRadians(theta_o)) - std::sin(DegreesToRadians(theta_i));
      const double rho = 0.005 + 2e-3 / (1e-6 + off * off);
      scan.samples.directions.push_back(at);
      scan.samples.angles.push_back(ToHalfDiff(ToDirections(at)));
      scan.samples.rho.push_back({rho, rho, rho});
    }
  }
  return scan;
}

double LargestAlbedo(const FactorModel& model) {
  const PreparedModel<double> prepared(model);
  double largest = 0;
  for (const double degrees : {5.0, 12.0, 18.0, 25.0, 32.0, 41.4, 50.0, 60.0, 68.0, 75.0}) {
    largest = std::max(
        largest, DirectionalAlbedo(
                     [&](const DirectionPair& pair) { return prepared.Value(pair.wi, pair.wo); },
                     DegreesToRadians(degrees))[0]);
  }
  return largest;
}

TEST(DimHighlights, BetweenTheIncidencesOfAScanAFitMakesNoLight) {
  const FitResult fit = Fit(Scan(), {.compare = false});
  EXPECT_LT(LargestAlbedo(fit.model()), 1.1);
  EXPECT_LT(fit.score.relative_objective, 5e-4);
}

TEST(DimHighlights, WhatIsNotTooBrightStaysAsItIs) {
  const BrdfSamples samples = Scan().samples;
  FactorModel model(ModelSpec::SharedFactors(1).ForScattered(samples.size()));
  std::ranges::fill(model.parameters(), 0.2);
  Objective objective(samples, model.spec(), FindWeighting("appearance"), 1);
  const FactorModel before = model;
  ASSERT_LT(LargestAlbedo(model), 1);
  EXPECT_FALSE(DimHighlights({}, &objective, &model));
  EXPECT_TRUE(std::ranges::equal(model.parameters(), before.parameters()));
  EXPECT_EQ(objective.samples().size(), samples.size());
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
