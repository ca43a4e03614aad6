#include "trilobe/model/model_spec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(ModelSpec, ParameterCountsOfThePaper) {
  // d 3 + s 9 + D 3 x 90 + F 3 x 90 + G 3 x 90
  EXPECT_EQ(ModelSpec::SharedFactors(3).num_parameters(), 822);
  EXPECT_EQ(ModelSpec{}.num_parameters(), 822);
  EXPECT_EQ(ModelSpec{}, ModelSpec::SharedFactors(3));
  // d 3 + s 3 + (D + F + G) x 3 x 90
  EXPECT_EQ(ModelSpec::IndependentG().num_parameters(), 816);
  EXPECT_EQ(ModelSpec::SharedFactors(0).num_parameters(), 3);
  EXPECT_EQ(ModelSpec::SharedFactors(1).num_parameters(), 3 + 3 + 90 + 270 + 90);
}

TEST(ModelSpec, TablesFollowTheGrid) {
  const MerlGrid grid{.theta_h = 7, .theta_d = 5, .phi_d = 9};
  const ModelSpec spec = ModelSpec::SharedFactors(2, grid);
  EXPECT_EQ(spec.table_size(Factor::kD), 7);
  EXPECT_EQ(spec.table_size(Factor::kF), 5);
  EXPECT_EQ(spec.table_size(Factor::kG), 5);
}

TEST(ModelSpec, SharedFactorsShareDAndGByChannelFByLobe) {
  const ModelSpec spec = ModelSpec::SharedFactors(3);
  EXPECT_EQ(spec.num_tables(Factor::kD), 3);
  EXPECT_EQ(spec.num_tables(Factor::kF), 3);
  EXPECT_EQ(spec.num_tables(Factor::kG), 3);
  for (int m = 0; m < 3; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_EQ(spec.table(Factor::kD, m, c), m);
      EXPECT_EQ(spec.table(Factor::kF, m, c), c);
      EXPECT_EQ(spec.table(Factor::kG, m, c), m);
    }
  }
}

TEST(ModelSpec, IndependentGSharesNothing) {
  const ModelSpec spec = ModelSpec::IndependentG();
  EXPECT_EQ(spec.lobes, 1);
  for (const Factor factor : kFactors) {
    EXPECT_EQ(spec.num_tables(factor), 3);
    for (int c = 0; c < kChannels; ++c) EXPECT_EQ(spec.table(factor, 0, c), c);
  }
}

// Two (lobe, channel) pairs read the same table exactly where the sharing says so.
TEST(ModelSpec, TablesAreSharedAsTold) {
  for (const auto& [name, spec] : TestSpecs({})) {
    for (const Factor factor : kFactors) {
      const TableSharing sharing = spec.sharing(factor);
      std::set<int> used;
      for (int m = 0; m < spec.lobes; ++m) {
        for (int c = 0; c < kChannels; ++c) {
          const int table = spec.table(factor, m, c);
          used.insert(table);
          for (int t = 0; t < spec.num_tables(factor); ++t) {
            EXPECT_EQ(spec.serves(factor, t, m, c), t == table) << name;
          }
          for (int n = 0; n < spec.lobes; ++n) {
            for (int e = 0; e < kChannels; ++e) {
              const bool same = (m == n || !sharing.per_lobe) && (c == e || !sharing.per_channel);
              EXPECT_EQ(table == spec.table(factor, n, e), same) << name;
            }
          }
        }
      }
      EXPECT_EQ(used.size(), static_cast<size_t>(spec.num_tables(factor))) << name;
    }
  }
}

TEST(ModelSpec, FactorNames) {
  EXPECT_STREQ(FactorName(Factor::kD), "D");
  EXPECT_STREQ(FactorName(Factor::kF), "F");
  EXPECT_STREQ(FactorName(Factor::kG), "G");
}

TEST(ModelSpec, RefusesWhatIsOutOfRange) {
  EXPECT_NO_THROW(CheckSpec(ModelSpec::SharedFactors(0)));
  EXPECT_NO_THROW(CheckSpec(ModelSpec::SharedFactors(kMaxLobes)));
  EXPECT_NO_THROW(CheckSpec(ModelSpec::SharedFactors(1, {4, 4, 1})));
  EXPECT_THAT(ErrorOf([&] { CheckSpec(ModelSpec::SharedFactors(-1)); }),
              IsError(ErrorKind::kRange, {.key = "lobes", .value = "-1"}));
  EXPECT_THAT(ErrorOf([&] { CheckSpec(ModelSpec::SharedFactors(kMaxLobes + 1)); }),
              IsError(ErrorKind::kRange, {.key = "lobes", .value = "9"}));
  // Longer tables would overflow the indices of the folded grid.
  const auto with_nodes = [](int nodes) {
    return ModelSpec{.g_axis = {.rule = Axis::Rule::kSpline, .size = nodes}};
  };
  EXPECT_NO_THROW(CheckSpec(with_nodes(kMaxBins)));
  EXPECT_THAT(ErrorOf([&] { CheckSpec(with_nodes(kMaxBins + 1)); }),
              IsError(ErrorKind::kRange, {.key = "G", .value = "1025"}));
  for (Axis ModelSpec::*axis : {&ModelSpec::d_axis, &ModelSpec::f_axis, &ModelSpec::g_axis}) {
    for (const int bad : {3, 0, -90}) {
      ModelSpec spec;
      (spec.*axis).size = bad;
      EXPECT_THAT(ErrorOf([&] { CheckSpec(spec); }),
                  IsError(ErrorKind::kRange, {.value = std::to_string(bad)}));
    }
  }
}

// Splines have about three nodes for two theta of the data, and one at 75 degrees.
TEST(ModelSpec, SplinesForFewThetaHaveANodeWhereDataEnd) {
  for (const auto& [thetas, nodes] : {std::pair(1, 9), {6, 9}, {12, 15}, {20, 27}, {1000, 87}}) {
    Axis axis{.rule = Axis::Rule::kSpline, .size = Axis::SplineNodesFor(thetas)};
    EXPECT_EQ(axis.size, nodes) << thetas;
    const Stencil stencil = axis.At(DegreesToRadians(75), 0);
    for (int i = 0; i < stencil.size; ++i) {
      const bool at_end = std::abs(axis.Theta(stencil.index[i]) - DegreesToRadians(75)) < 1e-9;
      EXPECT_NEAR(stencil.weight[i], at_end ? 1 : 0, 1e-9) << thetas;
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
