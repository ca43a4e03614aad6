#include "core/base/quantile.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace trilobe {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Quantile, IsOneOfTheValues) {
  std::vector<double> values = {4, 1, 3, 2};
  EXPECT_EQ(Quantile(&values, 0), 1);
  EXPECT_EQ(Quantile(&values, 0.5), 2);
  EXPECT_EQ(Quantile(&values, 1), 4);
}

TEST(Median, OfAnEvenNumberIsTheMeanOfTheTwoInTheMiddle) {
  EXPECT_EQ(Median({7}), 7);
  EXPECT_EQ(Median({3, 1, 2}), 2);
  EXPECT_EQ(Median({9, 1, 2, 5}), 3.5);
  EXPECT_EQ(UpperMedian({9, 1, 2, 5}), 5);
}

TEST(Median, IsInfiniteIfHalfOfTheValuesAre) {
  EXPECT_EQ(Median({1, kInfinity, 2}), 2);
  EXPECT_EQ(Median({kInfinity, 1}), kInfinity);
  EXPECT_EQ(Median({kInfinity, 1, kInfinity, 2}), kInfinity);
}

}  // namespace
}  // namespace trilobe
