#include "trilobe/model/merge_lobes.h"

#include <gtest/gtest.h>

#include "tests/test_util.h"
#include "trilobe/base/error.h"

namespace trilobe {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 4};

double LargestDifference(const FactorModel& a, const FactorModel& b) {
  double largest = 0;
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    for (int c = 0; c < kChannels; ++c) {
      const double x = Evaluate(a, GridStencils(a.spec(), kGrid, bin), c);
      const double y = Evaluate(b, GridStencils(b.spec(), kGrid, bin), c);
      largest = std::max(largest, std::abs(x - y) / y);
    }
  }
  return largest;
}

TEST(MergeLobes, WithoutALobeThatReflectsNothingAllIsTheSame) {
  for (const NamedSpec& named : TestSpecs(kGrid)) {
    FactorModel model = RandomModel(named.spec, 1);
    for (int m = 0; m < named.spec.lobes; ++m) {
      FactorModel without = model;
      std::ranges::fill(without.s(m), 0.0);
      EXPECT_LT(LargestDifference(WithoutLobe(without, m), without), 1e-14) << named.name;
    }
  }
}

TEST(MergeLobes, LobesThatDifferInSAndDAloneBecomeOneWithoutLoss) {
  FactorModel model = RandomModel(ModelSpec::SharedFactors(3, kGrid), 1);
  std::ranges::copy(model.table(Factor::kG, 0), model.table(Factor::kG, 2).begin());
  std::ranges::copy(model.s(0), model.s(2).begin());
  for (double& s : model.s(2)) s *= 0.25;
  const FactorModel merged = WithLobesMerged(model, 0, 2);
  EXPECT_EQ(merged.spec().lobes, 2);
  EXPECT_LT(LargestDifference(merged, model), 1e-14);
}

TEST(MergeLobes, NamesLobesThatAreNotThere) {
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(2, kGrid), 1);
  EXPECT_THROW(WithoutLobe(model, 2), Error);
  EXPECT_THROW(WithLobesMerged(model, 0, -1), Error);
  EXPECT_THROW(WithLobesMerged(model, 1, 1), Error);
}

}  // namespace
}  // namespace trilobe
