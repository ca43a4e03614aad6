#include "solvers/joint/log_stepper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/model/anisotropic_samples.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};

// Steps with a stiffness that falls; what each does to E + penalty.
void ExpectEachStepLowers(const Objective& objective, const FactorModel& start,
                          const std::string& what) {
  PhaseSeconds phases;
  LogStepper stepper(objective, &phases);
  stepper.Restart(start);
  const double E_before = stepper.E();
  int accepted = 0;
  for (const double stiffness : {1e-3, 1e-5, 1e-7, 0.0}) {
    stepper.set_stiffness(stiffness);
    for (int k = 0; k < 5; ++k) {
      const double before = stepper.E() + stepper.penalty();
      const bool lower = stepper.Step();
      accepted += lower;
      const double after = stepper.E() + stepper.penalty();
      EXPECT_EQ(after < before, lower) << what;
      EXPECT_LE(after, before) << what;
      EXPECT_EQ(stepper.E(), objective.Value(stepper.current())) << what;
      for (const double x : stepper.current().parameters()) {
        ASSERT_TRUE(std::isfinite(x) && x >= 0) << what;
      }
    }
  }
  EXPECT_GE(accepted, 10) << what;
  EXPECT_LT(stepper.E(), 0.9 * E_before) << what;
}

TEST(LogStepper, EachStepLowersWhatIsMinimised) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    if (spec.lobes == 0) continue;
    ExpectEachStepLowers(MakeObjective(RandomTable(kGrid, 1), spec, "appearance"),
                         RandomModel(spec, 2), name);
  }
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective scattered(Scattered(ValidSamples(RandomTable(kGrid, 1))), spec,
                            FindWeighting("appearance"));
  ExpectEachStepLowers(scattered, RandomModel(spec, 2), "scattered");
  const ModelSpec polar = ModelSpec::AnisotropicFor(1, 12, 1.3);
  const Objective anisotropic(PolarSamples(RandomModel(polar, 1), 3, 12), polar,
                              FindWeighting("appearance"));
  ExpectEachStepLowers(anisotropic, RandomModel(polar, 2), "anisotropic");
}

TEST(LogStepper, ComesToAnExactFit) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const FactorModel truth = RandomModel(spec, 5, 0.7);
  const Objective objective = MakeObjective(TableOf(truth, kGrid), spec);
  PhaseSeconds phases;
  LogStepper stepper(objective, &phases);
  FactorModel start = truth;
  Random random(5);
  for (double& x : start.parameters()) x *= random.LogNormal(0.1);
  stepper.Restart(start);
  for (int k = 0; k < 12; ++k) stepper.Step();
  EXPECT_LT(stepper.E(), 1e-20 * objective.MeasuredEnergy());
}

TEST(LogStepper, StiffTablesAreSteady) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  PhaseSeconds phases;
  LogStepper stepper(objective, &phases);
  stepper.Restart(RandomModel(spec, 2));
  stepper.set_stiffness(1e4);
  for (int k = 0; k < 30; ++k) stepper.Step();
  const std::span<const double> D = stepper.current().D(0, 0);
  for (size_t k = 1; k + 1 < D.size(); ++k) {
    EXPECT_NEAR(D[k] * D[k] / (D[k - 1] * D[k + 1]), 1, 1e-4);
  }
}

// Zeros move again, but those that no data touch are the caller's.
TEST(LogStepper, LiftsZerosAndLeavesTheUnobserved) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  BrdfTable table = TableOf(RandomModel(spec, 1), kGrid);
  InvalidateThetaH(4, 1, &table);
  const Objective objective = MakeObjective(table, spec);
  FactorModel start = RandomModel(spec, 2);
  start.table(Factor::kD, 0)[1] = 0;
  start.table(Factor::kD, 0)[4] = 0;
  PhaseSeconds phases;
  LogStepper stepper(objective, &phases);
  stepper.Restart(start);
  for (int k = 0; k < 10; ++k) stepper.Step();
  EXPECT_GT(stepper.current().table(Factor::kD, 0)[1], 0);
  EXPECT_EQ(stepper.current().table(Factor::kD, 0)[4], 0);
  EXPECT_EQ(stepper.current().table(Factor::kD, 1)[4], start.table(Factor::kD, 1)[4]);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
