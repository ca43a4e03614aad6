#include "core/base/lanes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(ArcFunctions, AnglesAreExactFromTheNormalToTheHorizon) {
  for (double sin2 = 1; sin2 > 1e-30; sin2 *= 0.99) {
    const Four<double> four = AnglesOfSines2<double>(Four<double>{sin2, 0, 1, 0.5});
    const double expected = std::asin(std::sqrt(sin2));
    // Near 1, sin2 itself says less.
    ASSERT_NEAR(four[0], expected, sin2 < 0.99 ? 1e-14 * expected : 1e-9);
    ASSERT_EQ(four[1], 0);
    ASSERT_NEAR(four[2], kPi / 2, 1e-15);
    ASSERT_NEAR(four[3], kPi / 4, 1e-14);
    const Four<float> floats =
        AnglesOfSines2<float>(Four<float>{static_cast<float>(sin2), 0, 1, 0});
    ASSERT_NEAR(floats[0], expected, sin2 < 0.99 ? 1e-6 * expected : 1e-4);
    ASSERT_EQ(floats[1], 0);
  }
}

TEST(ArcFunctions, PartsAddUp) {
  for (const double x : {0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 88.75, 89.0, 1023.999, 1048575.5}) {
    const Parts<double> parts(Four<double>{x - 0.5, 0, 0, 0});
    EXPECT_EQ(parts.whole(0) + parts.upper[0], x);
    EXPECT_TRUE(parts.upper[0] >= 0 && parts.upper[0] <= 1) << x;
    EXPECT_EQ(parts.lower[0], 1 - parts.upper[0]);
    EXPECT_GE(parts.whole(0), 0) << x;
    const Parts<float> floats(Four<float>{0, static_cast<float>(x) - 0.5F, 0, 0});
    EXPECT_EQ(static_cast<float>(floats.whole(1)) + floats.upper[1], static_cast<float>(x));
    EXPECT_TRUE(floats.upper[1] >= 0 && floats.upper[1] <= 1) << x;
  }
}

TEST(ArcFunctions, TurnsGoOnceAroundTheCircle) {
  for (double expected = 0; expected < 1; expected += 1.0 / 1024) {
    for (const double radius : {1e-12, 1.0, 1e9}) {
      const double x = radius * std::cos(2 * kPi * expected);
      const double y = radius * std::sin(2 * kPi * expected);
      const Four<double> four = Turns<double>(Four<double>{x, 0, 1, -1}, Four<double>{y, 0, 0, 0});
      ASSERT_NEAR(four[0] - std::round(four[0] - expected), expected, 2e-15) << radius;
      ASSERT_EQ(four[1], 0);
      ASSERT_EQ(four[2], 0);
      ASSERT_EQ(four[3], 0.5);
      const Four<float> floats = Turns<float>(Four<float>{static_cast<float>(x), 0, 0, 0},
                                              Four<float>{static_cast<float>(y), 1, -1, 0});
      ASSERT_NEAR(floats[0] - std::round(floats[0] - expected), expected, 1e-7) << radius;
      ASSERT_EQ(floats[1], 0.25F);
      ASSERT_EQ(floats[2], 0.75F);
      ASSERT_GE(floats[0], 0);
      ASSERT_LE(floats[0], 1);
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
