#include "model/objective/unclamped_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid = {.theta_h = 12, .theta_d = 10, .phi_d = 16};

// Angles of two directions above the surface, not at bin centres.
HalfDiffAngles RandomAngles(Random* random) {
  while (true) {
    const HalfDiffAngles angles = {random->Uniform(0, kPi / 2), random->Uniform(0, kPi / 2),
                                   random->Uniform(0, kPi)};
    const Cosines cosines = ToCosines(angles);
    if (cosines.i > 1e-3 && cosines.o > 1e-3) return angles;
  }
}

// How each stretch of the lobes reads D.
std::vector<Stencil> ReadingsOfD(const ModelSpec& spec, const SampleStencils& at) {
  std::vector<Stencil> D;
  for (size_t k = 0; k < spec.stretches.distinct().size(); ++k) {
    D.push_back(at.DOf(static_cast<int>(k)));
  }
  return D;
}

void ExpectNear(const Rgb& rho, const FactorModel& model, const SampleStencils& stencils,
                const std::string& what) {
  for (int c = 0; c < kChannels; ++c) {
    const double expected = UnclampedValue(model, stencils, c);
    ASSERT_NEAR(rho[c], expected, 1e-13 * std::abs(expected)) << what << ", channel " << c;
  }
}

TEST(UnclampedModelTest, EqualsTheStencilsInAnyDirections) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const FactorModel model = RandomModel(spec, 5, 0.3);
    const UnclampedModel unclamped(model);
    Random random(1);
    for (int k = 0; k < 2000; ++k) {
      const HalfDiffAngles angles = RandomAngles(&random);
      const Cosines cosines = ToCosines(angles);
      const SampleStencils stencils = ScatteredStencils(spec, angles);
      ExpectNear(unclamped(angles, cosines), model, stencils, name);
      ExpectNear(unclamped(ReadingsOfD(spec, stencils), stencils.F, cosines), model, stencils,
                 name);
    }
  }
}

TEST(UnclampedModelTest, EqualsTheStencilsAtBinCentres) {
  const std::vector<bool> above = BinsAboveSurface(kGrid);
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const FactorModel model = RandomModel(spec, 6, 0.3);
    const UnclampedModel unclamped(model);
    for (int bin = 0; bin < kGrid.size(); ++bin) {
      if (!above[bin]) continue;
      const SampleStencils at = GridStencils(spec, kGrid, bin);
      const Cosines cosines = ToCosines(kGrid.Center(bin));
      ExpectNear(unclamped(ReadingsOfD(spec, at), at.F, cosines), model, at, name);
      if (spec.stretches.any()) continue;
      const int row = bin / kGrid.phi_d;
      const Stencil D = PointStencil(row / kGrid.theta_d);
      ExpectNear(unclamped({&D, 1}, PointStencil(row % kGrid.theta_d), cosines), model, at, name);
    }
  }
}

// A negative weight of the spline, where G may undershoot. What E sees is not bounded.
TEST(UnclampedModelTest, MayBeNegative) {
  FactorModel model(ModelSpec::SharedFactors(1, kGrid));
  for (double& x : model.parameters()) x = 1;
  for (double& d : model.d()) d = 0;
  for (double& g : model.table(Factor::kG, 0)) g = 0;
  model.table(Factor::kG, 0)[5] = 1;
  const UnclampedModel unclamped(model);
  const double step = kPi / 2 / model.spec().g_axis.size, node = 5.5 * step;
  double lowest = 0;
  for (double beside = -2.5; beside <= 2.5; beside += 0.1) {
    const double theta_o = node + beside * step;
    const DirectionPair pair = {{std::sin(node), 0, std::cos(node)},
                                {0, std::sin(theta_o), std::cos(theta_o)}};
    const HalfDiffAngles angles = ToHalfDiff(pair);
    const double expected =
        UnclampedValue(model, ScatteredStencils(model.spec(), angles), /*channel=*/0);
    lowest = std::min(lowest, expected);
    ASSERT_NEAR(unclamped(angles, ToCosines(angles))[0], expected, 1e-12);
    ASSERT_NEAR(Evaluate(model, pair)[0], std::max(expected, 0.0), 1e-12);
    ASSERT_GE(Evaluate(model, pair)[0], 0);
  }
  EXPECT_LT(lowest, -1e-3);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
