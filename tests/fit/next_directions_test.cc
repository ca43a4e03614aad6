#include "fit/next_directions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// A synthetic material at these directions.
Measurement Measured(const std::string& name, const std::vector<SphericalAngles>& directions) {
  const BrdfFunction brdf = FindSynthMaterial(name).brdf;
  SampleCollector collector("some.csv", "samples");
  for (const SphericalAngles& at : directions) collector.Add(at, brdf(ToDirections(at)));
  return collector.Take();
}

FitOptions Quick(int num_threads = 1) {
  FitOptions options{.solver = "awls", .raw = true, .num_threads = num_threads};
  options.form.lobes = 1;
  options.appearance.lights = 20;
  options.appearance.size = 24;
  options.solver_options = [](const ModelSpec& /*spec*/) {
    SolverOptions solver;
    solver.max_iterations = 3;
    return solver;
  };
  return options;
}

bool IsSame(const SphericalAngles& a, const SphericalAngles& b) {
  return a.theta_i == b.theta_i && a.theta_o == b.theta_o && a.phi_o == b.phi_o;
}

TEST(NextDirections, AreOthersAndTheFirstOfMoreAreTheSame) {
  const std::vector<SphericalAngles> plan = DirectionsToMeasure(40, {});
  const Measurement measured = Measured("plastic", plan);
  const NextDirections few = NextDirectionsToMeasure(measured, 5, NextBy::kBoth, {}, Quick());
  ASSERT_EQ(few.directions.size(), 5U);
  EXPECT_EQ(few.measured, 40);
  for (const SphericalAngles& at : few.directions) {
    for (const SphericalAngles& before : plan) EXPECT_FALSE(IsSame(at, before));
  }
  ASSERT_TRUE(few.now);
  EXPECT_GT(few.now->mean_delta_e, 0);
  ASSERT_TRUE(few.expected_delta_e);
  EXPECT_LT(*few.expected_delta_e, few.now->mean_delta_e);
  const NextDirections more = NextDirectionsToMeasure(measured, 8, NextBy::kBoth, {}, Quick(2));
  for (size_t k = 0; k < few.directions.size(); ++k) {
    EXPECT_TRUE(IsSame(few.directions[k], more.directions[k])) << k;
  }
}

// The device is told once, for the plan and for what comes next.
TEST(NextDirections, KeepToTheDevice) {
  const Goniometer device{.in_plane = true, .step = DegreesToRadians(5)};
  const Measurement measured = Measured("copper", DirectionsToMeasure(20, device));
  const NextDirections next =
      NextDirectionsToMeasure(measured, 6, NextBy::kDesign, device, Quick());
  EXPECT_EQ(next.directions.size(), 6U);
  EXPECT_FALSE(next.now);  // fewer than 32 samples
  EXPECT_FALSE(next.expected_delta_e);
  for (const SphericalAngles& at : next.directions) {
    EXPECT_TRUE(at.phi_o == 0 || at.phi_o == kPi) << at.phi_o;
    EXPECT_NEAR(std::remainder(RadiansToDegrees(at.theta_o), 5), 0, 1e-9);
  }
}

TEST(NextDirections, GoOnWithThePlanByTurns) {
  const std::vector<SphericalAngles> plan = DirectionsToMeasure(24, {});
  const Measurement measured =
      Measured("plastic", std::vector<SphericalAngles>(plan.begin(), plan.begin() + 20));
  const auto next = [&](NextBy by) {
    return NextDirectionsToMeasure(measured, 4, by, {}, Quick()).directions;
  };
  const std::vector<SphericalAngles> by_plan = next(NextBy::kPlan), by_both = next(NextBy::kBoth),
                                     by_design = next(NextBy::kDesign);
  for (int k = 0; k < 4; ++k) EXPECT_TRUE(IsSame(by_plan[k], plan[20 + k])) << k;
  EXPECT_TRUE(IsSame(by_both[0], by_design[0]));
  EXPECT_TRUE(IsSame(by_both[1], plan[20]));
  EXPECT_TRUE(IsSame(by_both[3], plan[21]));
  EXPECT_FALSE(IsSame(by_design[1], plan[20]));
}

TEST(NextDirections, AreChosenByAName) {
  for (const NextBy by : {NextBy::kPlan, NextBy::kDesign, NextBy::kBoth}) {
    EXPECT_EQ(FindNextBy(NameOf(by)), by);
  }
  const auto thrown = ErrorOf([] { FindNextBy("luck"); });
  ASSERT_TRUE(thrown);
  EXPECT_EQ(thrown->kind(), ErrorKind::kUnknown);
}

// Nothing is seen of it, and no number of the design is of any use.
TEST(NextDirections, OfABlackMaterialGoOnWithThePlan) {
  const std::vector<SphericalAngles> plan = DirectionsToMeasure(16, {});
  SampleCollector collector("black.csv", "samples");
  for (int k = 0; k < 12; ++k) collector.Add(plan[k], {});
  const NextDirections next =
      NextDirectionsToMeasure(collector.Take(), 4, NextBy::kDesign, {}, Quick());
  ASSERT_EQ(next.directions.size(), 4U);
  for (int k = 0; k < 4; ++k) EXPECT_TRUE(IsSame(next.directions[k], plan[12 + k])) << k;
}

TEST(NextDirections, WhatCannotBeIsAnError) {
  const auto refused = [](const Measurement& measured, int count, const Goniometer& device = {}) {
    const auto thrown =
        ErrorOf([&] { NextDirectionsToMeasure(measured, count, NextBy::kPlan, device, Quick()); });
    EXPECT_TRUE(thrown && thrown->facts().key == "next");
    return thrown ? thrown->kind() : ErrorKind::kFile;
  };
  const Measurement some = Measured("plastic", DirectionsToMeasure(20, {}));
  EXPECT_EQ(refused(some, 0), ErrorKind::kRange);
  EXPECT_EQ(refused(some, kMostNext + 1), ErrorKind::kRange);
  EXPECT_EQ(refused(some, 20, {.in_plane = true, .step = DegreesToRadians(40)}), ErrorKind::kRange);
  EXPECT_EQ(refused(Measured("plastic", DirectionsToMeasure(kLeastMeasured - 1, {})), 5),
            ErrorKind::kData);
  EXPECT_EQ(refused(LoadMeasurement("synth:plastic@9x9x18"), 5), ErrorKind::kUnsupported);
  EXPECT_EQ(refused(LoadMeasurement("synth:linen@3x8"), 5), ErrorKind::kUnsupported);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
