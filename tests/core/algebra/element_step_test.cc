#include "core/algebra/element_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// change(delta) = A (x + delta - u)^2 (x + delta - v)^2 - its value at delta = 0: wells at u and v,
// tilted by `tilt` (x + delta), written out in powers of delta.
ElementQuartic DoubleWell(double x, double A, double u, double v, double tilt) {
  const double p = x - u, q = x - v;  // A (delta + p)^2 (delta + q)^2
  return {.c1 = A * 2 * p * q * (p + q) + tilt,
          .c2 = A * (p * p + 4 * p * q + q * q),
          .c3 = A * 2 * (p + q),
          .c4 = A};
}

TEST(ElementStep, AddSampleIsTheSquaredResidual) {
  ElementQuartic change;
  const double w = 2, r = 0.7, p1 = 1.3, p2 = -0.4;
  change.AddSample(w, r, p1, p2);
  change.AddSample(3, -0.2, 0.5, 0.1);
  for (double delta = -2; delta <= 2; delta += 0.25) {
    const double first = r - p1 * delta - p2 * delta * delta;
    const double second = -0.2 - 0.5 * delta - 0.1 * delta * delta;
    const double expected = w * (first * first - r * r) + 3 * (second * second - 0.04);
    EXPECT_NEAR(change(delta), expected, 1e-13);
  }
}

TEST(ElementStep, ParabolaGoesToItsMinimum) {
  // E = (x - 5)^2, seen from x = 2.
  EXPECT_EQ(BestElement(2, {.c1 = -6, .c2 = 1}), 5);
  EXPECT_EQ(BestElement(9, {.c1 = 8, .c2 = 1}), 5);
}

TEST(ElementStep, ParabolaStopsAtTheBound) {
  // E = (x + 5)^2.
  EXPECT_EQ(BestElement(2, {.c1 = 14, .c2 = 1}), 0);
  EXPECT_EQ(BestElement(0, {.c1 = 10, .c2 = 1}), 0);
}

TEST(ElementStep, KeepsWhatNothingLowers) {
  EXPECT_EQ(BestElement(3, {}), 3);
  EXPECT_EQ(BestElement(0, {}), 0);
  EXPECT_EQ(BestElement(3, {.c1 = 0, .c2 = 1}), 3);
  EXPECT_EQ(BestElement(3, {.c1 = 0, .c2 = 1, .c3 = 0, .c4 = 1}), 3);
  EXPECT_EQ(BestElement(0, {.c1 = 1, .c2 = 0}), 0);
  // An improvement below the rounding error of E's own terms.
  EXPECT_EQ(BestElement(1, {.c1 = 1e-17, .c2 = 1}), 1);
}

TEST(ElementStep, DegenerateSlopesGoToTheBoundOrStay) {
  // E falls towards infinity (no real E does): no stationary point to go to.
  EXPECT_EQ(BestElement(3, {.c1 = -1, .c2 = 0}), 3);
  EXPECT_EQ(BestElement(3, {.c1 = 1, .c2 = 0}), 0);
}

TEST(ElementStep, NeverBeyondTheLargestParameter) {
  EXPECT_EQ(BestElement(1, {.c1 = -1e70, .c2 = 0.5e-3}), 1);
  const double inside = BestElement(1, {.c1 = -2e50, .c2 = 1});
  EXPECT_DOUBLE_EQ(inside, 1e50);
}

TEST(ElementStep, DoubleWellChoosesTheLowerOne) {
  for (const double start : {0.5, 1.0, 2.0, 3.0, 4.0}) {
    EXPECT_NEAR(BestElement(start, DoubleWell(start, 1, 1, 3, 0.1)), 1, 0.02) << start;
    EXPECT_NEAR(BestElement(start, DoubleWell(start, 1, 1, 3, -0.1)), 3, 0.02) << start;
  }
  // The lower well lies below 0: the best of the other and of the bound.
  EXPECT_NEAR(BestElement(3, DoubleWell(3, 1, -2, 2, 0.1)), 2, 0.02);
  EXPECT_EQ(BestElement(3, DoubleWell(3, 1, -0.1, 2, 10)), 0);
}

TEST(ElementStep, LeadingTermsThatVanishAgainstTheOthers) {
  // A parabola with a leading coefficient that is rounding noise: its far well is no improvement.
  EXPECT_NEAR(BestElement(2, {.c1 = -6, .c2 = 1, .c3 = 1e-25, .c4 = 1e-45}), 5, 1e-14);
  EXPECT_NEAR(BestElement(2, {.c1 = -6, .c2 = 1, .c3 = 0, .c4 = 1e-300}), 5, 1e-14);
}

// E of a node of G as it really comes: a sum of squares of residuals that are quadratic in delta.
TEST(ElementStep, QuarticsAgainstAScan) {
  Random random(1);
  for (int trial = 0; trial < (kSanitized ? 300 : 3000); ++trial) {
    const double x = trial % 5 == 0 ? 0 : random.LogNormal(1);
    ElementQuartic change;
    const int samples = 1 + trial % 4;
    for (int n = 0; n < samples; ++n) {
      const double p2 = trial % 3 == 0 ? 0 : random.Normal();
      change.AddSample(random.Uniform(), random.Normal(), random.Normal(), p2);
    }
    const double best = BestElement(x, change);
    ASSERT_GE(best, 0);
    const double value = change(best - x);
    ASSERT_LE(value, 0);
    double scanned = 0;
    for (int n = 0; n <= 4000; ++n) scanned = std::min(scanned, change(n * 0.005 - x));
    ASSERT_LE(value, scanned + 1e-12 * (1 + std::abs(scanned))) << "trial " << trial;
  }
}

TEST(ElementStep, ExtremeCoefficientsStayFiniteAndNeverRaiseE) {
  const std::vector<double> values = {0,      1,       -1,    1e150,  -1e150,
                                      1e-150, -1e-150, 1e300, -1e300, 5e-324};
  for (const double x : {0.0, 1e-150, 1.0, 1e50}) {
    for (const double c1 : values) {
      for (const double c2 : values) {
        for (const double c3 : values) {
          for (const double c4 : values) {
            const ElementQuartic change{c1, c2, c3, c4};
            const double best = BestElement(x, change);
            ASSERT_TRUE(best >= 0 && best <= kMaxParameter);
            if (best == x) continue;
            const long double delta = static_cast<long double>(best) - x;
            const long double value = delta * (c1 + delta * (c2 + delta * (c3 + delta * c4)));
            ASSERT_LT(value, 0) << x << " to " << best << ": " << c1 << " " << c2 << " " << c3
                                << " " << c4;
          }
        }
      }
    }
  }
}

TEST(ElementStep, CoefficientsThatAreNoNumbersChangeNothing) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double bad : {kInf, -kInf, std::nan("")}) {
    EXPECT_EQ(BestElement(2, {.c1 = bad, .c2 = bad}), 2);
    EXPECT_EQ(BestElement(2, {.c1 = bad, .c2 = 1}), 2);
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
