#include "trilobe/model/objective/folded_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 10, .theta_d = 12, .phi_d = 16};

Objective ScatteredObjective(const BrdfSamples& samples) {
  return {samples, ModelSpec::SharedFactors(2, kGrid), FindWeighting("compressive")};
}

// Both orders of a pair of directions, whose angles differ by rounding, and a sample that comes
// three times, become one each.
TEST(FoldedSamples, FoldsExchangedDirectionsAndDuplicates) {
  const BrdfSamples once = Scattered(ValidSamples(RandomTable(kGrid, 1, 0)));
  const Objective objective = ScatteredObjective(once);
  ASSERT_EQ(once.size() % 2, 0);  // no bin is its own mirror
  EXPECT_EQ(objective.folded_samples()->size(), once.size() / 2);

  BrdfSamples thrice = once;
  for (int copy = 0; copy < 2; ++copy) {
    thrice.angles.insert(thrice.angles.end(), once.angles.begin(), once.angles.end());
    thrice.rho.insert(thrice.rho.end(), once.rho.begin(), once.rho.end());
  }
  const Objective folded = ScatteredObjective(thrice);
  EXPECT_EQ(folded.folded_samples()->size(), once.size() / 2);
  const FactorModel model = RandomModel(objective.spec(), 2);
  EXPECT_NEAR(folded.Value(model), 3 * objective.Value(model), 1e-12 * folded.Value(model));
  EXPECT_NEAR(folded.MeasuredEnergy(), 3 * objective.MeasuredEnergy(),
              1e-12 * folded.MeasuredEnergy());
}

// Samples that differ by more than rounding stay apart, and E is the sum over all samples for any
// weights and values, 0 among them.
TEST(FoldedSamples, KeepsWhatReadsOtherwiseApart) {
  BrdfSamples samples = Scattered(ValidSamples(RandomTable(kGrid, 3, 0)));
  const int size = samples.size();
  Random random(4);
  for (int j = 0; j < size; ++j) samples.multiplicity.push_back(j % 5 == 0 ? 0 : random.Uniform());
  const Objective together = ScatteredObjective(samples);
  for (HalfDiffAngles& at : samples.angles) {
    if (at.phi_d > kPi / 2) at.theta_h *= 1 - 1e-9;
  }
  const Objective apart = ScatteredObjective(samples);
  EXPECT_EQ(apart.folded_samples()->size(), size);
  const FactorModel model = RandomModel(together.spec(), 5);
  for (const Objective* const objective : {&together, &apart}) {
    const auto expected = static_cast<double>(ExactObjective(*objective, model));
    EXPECT_NEAR(objective->Value(model), expected, 1e-12 * expected);
  }
}

// A model that fits both of a pair exactly leaves nothing; one pair that disagrees leaves the
// constant.
TEST(FoldedSamples, ConstantIsWhatPairsDisagreeBy) {
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(2, kGrid), 6, 0.1);
  BrdfSamples samples = Scattered(ValidSamples(TableOf(model, kGrid)));
  EXPECT_LE(ScatteredObjective(samples).folded_samples()->constant,
            1e-28 * ScatteredObjective(samples).MeasuredEnergy());
  const int mirror = static_cast<int>(
      std::ranges::find_if(samples.angles,
                           [&](const HalfDiffAngles& at) {
                             const HalfDiffAngles& first = samples.angles[0];
                             return at.theta_h == first.theta_h && at.theta_d == first.theta_d &&
                                    std::abs(at.phi_d - (kPi - first.phi_d)) < 1e-9;
                           }) -
      samples.angles.begin());
  ASSERT_LT(mirror, samples.size());
  samples.rho[mirror][1] *= 2;
  const Objective objective = ScatteredObjective(samples);
  const double w1 = objective.Sample(0).weight[1], w2 = objective.Sample(mirror).weight[1];
  const double difference = samples.rho[mirror][1] - samples.rho[0][1];
  const double expected = w1 * w2 / (w1 + w2) * difference * difference;
  EXPECT_NEAR(objective.folded_samples()->constant, expected, 1e-12 * expected);
}

// Samples are sorted by both cells of G, in ranges that cover them all.
TEST(FoldedSamples, AreSortedByTheirCells) {
  const Objective objective = ScatteredObjective(Scattered(ValidSamples(RandomTable(kGrid, 7))));
  const FoldedSamples& folded = *objective.folded_samples();
  int next = 0;
  for (const auto& [cell_i, cell_o, begin, end] : folded.pairs) {
    EXPECT_EQ(begin, next);
    EXPECT_GE(cell_i, cell_o);
    for (int j = begin; j < end; ++j) {
      EXPECT_EQ(folded.lookups[folded.order.G_i()].cell[j], cell_i);
      EXPECT_EQ(folded.lookups[folded.order.G_o()].cell[j], cell_o);
    }
    next = end;
  }
  EXPECT_EQ(next, folded.size());
}

// Stencils of no order, and a pair of exchanged points.
TEST(FoldedSamples, CellsOfAnyStencils) {
  std::vector<WeightedSample> samples(2);
  for (int j = 0; j < 2; ++j) {
    SampleStencils& at = samples[j].stencils;
    at.D = {4, {5, 6, 20, 15}, {0.1, 0.2, 0.3, 0.4}};
    at.F = LinearStencil(3.25, 9);
    at.G_i = PointStencil(j == 0 ? 3 : 8);
    at.G_o = PointStencil(j == 0 ? 8 : 3);
    at.inverse_cosines = 2;
    samples[j].weight = {1, 2, 3};
    samples[j].rho = {1, 1, 1};
  }
  const FoldedSamples folded = Fold(samples);
  ASSERT_EQ(folded.size(), 1);
  EXPECT_EQ(folded.weight[2][0], 6);
  ASSERT_EQ(folded.cells_of(Factor::kD).size(), 1U);
  EXPECT_EQ(folded.cells_of(Factor::kD)[0].size, 4);
  EXPECT_EQ(folded.lookups[0].weight[3][0], 0.4);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
