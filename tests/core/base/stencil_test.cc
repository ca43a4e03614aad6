#include "trilobe/core/base/stencil.h"

#include <gtest/gtest.h>

#include <vector>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

const std::vector<double> kTable = {1, 3, 2, 10, 4};

TEST(Stencil, PointReadsTheEntryItself) {
  const Stencil stencil = PointStencil(3);
  EXPECT_EQ(stencil.size, 1);
  EXPECT_EQ(stencil(kTable), 10);
  EXPECT_EQ(stencil.WeightOf(3), 1);
  EXPECT_EQ(stencil.WeightOf(2), 0);
}

TEST(Stencil, LinearIsExactAtCentresAndLinearBetween) {
  for (int k = 0; k < 5; ++k) EXPECT_EQ(LinearStencil(k + 0.5, 5)(kTable), kTable[k]);
  EXPECT_DOUBLE_EQ(LinearStencil(1.0, 5)(kTable), 2);     // half way from 1 to 3
  EXPECT_DOUBLE_EQ(LinearStencil(2.75, 5)(kTable), 4);    // a quarter of the way from 2 to 10
  EXPECT_DOUBLE_EQ(LinearStencil(4.25, 5)(kTable), 5.5);  // three quarters from 10 to 4
}

TEST(Stencil, LinearReadsOneEntryNextToItsCentre) {
  for (int k = 1; k < 4; ++k) {
    for (const double x : {k + 0.5 - 1e-15, k + 0.5 + 1e-15}) {
      const Stencil stencil = LinearStencil(x, 5);
      EXPECT_EQ(stencil.WeightOf(k), 1);
      EXPECT_EQ(stencil.WeightOf(k - 1), 0);
      EXPECT_EQ(stencil.WeightOf(k + 1), 0);
    }
  }
}

TEST(Stencil, LinearIsConstantBeyondTheOuterCentres) {
  for (const double x : {0.0, 0.25, 0.5}) {
    EXPECT_EQ(LinearStencil(x, 5)(kTable), 1);
    EXPECT_EQ(LinearStencil(5 - x, 5)(kTable), 4);
  }
}

TEST(Stencil, LinearWeightsAddUpToOneInsideTheTable) {
  for (double x = 0; x <= 5; x += 0.01) {
    const Stencil stencil = LinearStencil(x, 5);
    double sum = 0;
    for (int k = 0; k < stencil.size; ++k) {
      EXPECT_GE(stencil.index[k], 0);
      EXPECT_LT(stencil.index[k], 5);
      EXPECT_GE(stencil.weight[k], 0);
      EXPECT_EQ(stencil.WeightOf(stencil.index[k]), stencil.weight[k]);
      sum += stencil.weight[k];
    }
    EXPECT_DOUBLE_EQ(sum, 1);
  }
}

TEST(Stencil, LinearReadsNothingBesideWhatItStandsAt) {
  for (const double x : {0.0, 0.3, 0.5, 2.5, 2.5 + 0.9 * kAtEntry, 4.5 - 0.9 * kAtEntry, 5.0}) {
    EXPECT_EQ(LinearStencil(x, 5).size, 1) << x;
  }
  for (const double x : {0.5 + 2 * kAtEntry, 2.0, 4.5 - 2 * kAtEntry}) {
    EXPECT_EQ(LinearStencil(x, 5).size, 2) << x;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
