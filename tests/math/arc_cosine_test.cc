#include "trilobe/math/arc_cosine.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Against asin, which keeps its digits near 0: acos(1 - y) = 2 asin(sqrt(y / 2)).
TEST(ArcCosine, IsExactFromTheNormalToTheHorizon) {
  for (double y = 1; y > 1e-30; y *= 0.99) {
    std::array<double, 4> four = {y, 0, 1, y / 2};
    ArcCosinesOfOneMinus(&four);
    const double expected = 2 * std::asin(std::sqrt(y / 2));
    ASSERT_NEAR(four[0], expected, 2e-15 * expected);
    ASSERT_EQ(four[1], 0);
    ASSERT_NEAR(four[2], std::acos(0.0), 2e-15);
    std::array<float, 4> floats = {static_cast<float>(y), 0, 1, 0};
    ArcCosinesOfOneMinus(&floats);
    ASSERT_NEAR(floats[0], expected, 1e-6 * expected);
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
