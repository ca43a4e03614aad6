#include "core/base/linear_density.h"

#include <gtest/gtest.h>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(LinearDensity, IsInverted) {
  const double ends[] = {0, 1e-12, 1e-3, 0.5, 1, 1 + 1e-12, 1e6};
  for (const double a : ends) {
    for (const double b : ends) {
      if (a + b == 0) continue;
      for (double t = 0; t <= 1; t += 0.125) {
        const double value = LinearIntegral(t, a, b);
        const double inverse = InvertLinearIntegral(value, a, b);
        EXPECT_NEAR(LinearIntegral(inverse, a, b), value, 1e-14 * (a + b)) << a << " " << b;
        // Near the high end the last digits of the integral say little of t.
        EXPECT_NEAR(inverse, t, 1e-6) << a << " " << b;
      }
    }
  }
}

TEST(LinearDensity, EndsAtTheEnds) {
  EXPECT_EQ(InvertLinearIntegral(2.0, 1.0, 1.0), 1);
  EXPECT_EQ(InvertLinearIntegral(0.0, 0.0, 1.0), 0);
  EXPECT_EQ(InvertLinearIntegral(0.5F, 0.0F, 0.0F), 0);
  EXPECT_EQ(InvertLinearIntegral(-1.0, 1.0, 0.5), 0);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
