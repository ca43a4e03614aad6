#include "core/algebra/cubic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

struct Coefficients {
  double a, b, c, d;
  std::string Text() const {
    return std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + " " +
           std::to_string(d);
  }
  long double operator()(long double x) const { return ((a * x + b) * x + c) * x + d; }
  // The sum of the magnitudes of its terms: what rounding errors are relative to.
  long double Terms(long double x) const {
    const long double y = std::abs(x);
    return ((std::abs(a) * y + std::abs(b)) * y + std::abs(c)) * y + std::abs(d);
  }
};

std::vector<double> Roots(const Coefficients& p) {
  const RealRoots roots = SolveCubic(p.a, p.b, p.c, p.d);
  EXPECT_GE(roots.count, 0);
  EXPECT_LE(roots.count, 3);
  return {roots.root.begin(), roots.root.begin() + roots.count};
}

void ExpectRoots(const Coefficients& p, const std::vector<double>& expected,
                 double tolerance = kEpsilon) {
  const std::vector<double> roots = Roots(p);
  ASSERT_EQ(roots.size(), expected.size()) << p.Text();
  for (size_t k = 0; k < roots.size(); ++k) {
    EXPECT_NEAR(roots[k], expected[k], tolerance * std::abs(expected[k])) << p.Text();
  }
}

// Each root is one of a polynomial whose coefficients differ by rounding errors, they ascend, and
// the polynomial changes its sign nowhere but there.
void ExpectSound(const Coefficients& p) {
  const std::vector<double> roots = Roots(p);
  for (const double x : roots) {
    ASSERT_TRUE(std::isfinite(x)) << p.Text();
    ASSERT_LE(std::abs(p(x)), 4 * kEpsilon * p.Terms(x)) << p.Text() << " at " << x;
  }
  ASSERT_TRUE(std::ranges::is_sorted(roots, std::less_equal<>())) << p.Text();

  std::vector<double> ends = {-std::numeric_limits<double>::max()};
  ends.insert(ends.end(), roots.begin(), roots.end());
  ends.push_back(std::numeric_limits<double>::max());
  for (size_t gap = 0; gap + 1 < ends.size(); ++gap) {
    int sign = 0;
    const auto look = [&](double x) {
      if (!(x > ends[gap] && x < ends[gap + 1])) return;
      const long double value = p(x);
      if (std::abs(value) <= 8 * kEpsilon * p.Terms(x)) return;
      const int here = value < 0 ? -1 : 1;
      ASSERT_TRUE(sign == 0 || sign == here) << p.Text() << ": sign change missed before " << x;
      sign = here;
    };
    for (const double x : {-0.0, ends[gap] / 2 + ends[gap + 1] / 2}) look(x);
    for (double x = 0x1p-1020; x < 0x1p1020; x *= 2) {
      for (const double y : {-x, x, -1.5 * x, 1.5 * x}) look(y);
    }
    for (const double near : {ends[gap], ends[gap + 1]}) {  // closer and closer to a root
      for (double step = 0.5; step > 1e-15; step /= 4) {
        look(near * (1 + step));
        look(near * (1 - step));
      }
    }
  }
}

TEST(Cubic, ThreeRoots) {
  ExpectRoots({1, -6, 11, -6}, {1, 2, 3});
  ExpectRoots({-2, 0, 8, 0}, {-2, 0, 2});
  ExpectRoots({1, 0, -1e-10, 0}, {-1e-5, 0, 1e-5});
}

TEST(Cubic, OneRoot) {
  ExpectRoots({1, 0, 1, -2}, {1});       // (x - 1)(x^2 + x + 2)
  ExpectRoots({-3, 6, -15, -24}, {-1});  // -3 (x + 1)(x^2 - 3x + 8)
  ExpectRoots({1, 0, 0, -27}, {3});
}

TEST(Cubic, DoubleRoots) {
  ExpectRoots({1, -5, 7, -3}, {1, 3});   // (x - 1)^2 (x - 3)
  ExpectRoots({1, -7, 15, -9}, {1, 3});  // (x - 1)(x - 3)^2
  ExpectRoots({-4, -4, 0, 0}, {-1, 0});  // -4 x^2 (x + 1)
  ExpectRoots({1, 0, -3, 2}, {-2, 1});   // (x - 1)^2 (x + 2)
  ExpectRoots({1, 0, -3e8, 2e12}, {-2e4, 1e4});
}

TEST(Cubic, TripleRoots) {
  ExpectRoots({1, -6, 12, -8}, {2});
  ExpectRoots({8, 12, 6, 1}, {-0.5});
  ExpectRoots({5, 0, 0, 0}, {0});
  ExpectSound({1, -0.3, 0.03, -0.001});  // (x - 0.1)^3, as far as double can say it
}

TEST(Cubic, LeadingCoefficientsVanish) {
  ExpectRoots({0, 1, -3, 2}, {1, 2});
  ExpectRoots({0, 2, -4, 2}, {1});
  ExpectRoots({0, 1, 0, 1}, {});
  ExpectRoots({0, -3, 0, 0}, {0});
  ExpectRoots({0, 0, 4, -10}, {2.5});
  ExpectRoots({0, 0, -4, 0}, {0});
  ExpectRoots({0, 0, 0, 7}, {});
  ExpectRoots({0, 0, 0, 0}, {});
}

// Roots by mpmath.polyroots at 40 digits:
//   -1000000000000000000000000000003, 1.000000000000000000000000000001,
//   1.999999999999999999999999999992.
TEST(Cubic, LeadingCoefficientVanishesAgainstTheOthers) {
  ExpectRoots({1e-30, 1, -3, 2}, {-1e30, 1, 2});
  ExpectRoots({-1e-30, 1, -3, 2}, {1, 2, 1e30});
  ExpectRoots({1e-200, 0, 4, -10}, {2.5});
  ExpectRoots({1e-300, 1e-150, 1, -1}, {1});  // the others are complex
  // -1e160 and -1e155 from the outer pairs of terms.
  ExpectRoots({1e-160, 1, 1e155, 0}, {-1e160, -1e155, 0}, 1e-4);
}

// W. Kahan, To Solve a Real Cubic Equation (1986). Roots by mpmath.polyroots at 40 digits:
//   96.22963934659218218100493667835583587412
//   96.35706482518415207059175658483424 +- 0.06974975204368942543 i
// The complex pair is so near that one rounding error of long double in the last coefficient moves
// the real root by 2e-12.
TEST(Cubic, Kahan) {
  ExpectRoots({658, -190125, 18311811, -587898164}, {96.229639346592182}, 5e-14);
  ExpectSound({658, -190125, 18311811, -587898164});
}

TEST(Cubic, ExtremeCoefficients) {
  for (const double scale : {1e150, 1e-150, 1e300, 1e-300}) {
    ExpectRoots({scale, -6 * scale, 11 * scale, -6 * scale}, {1, 2, 3}, 1e-14);
    ExpectRoots({scale, 0, 0, -8 * scale}, {2});
  }
  ExpectRoots({1e150, 0, 0, -1e-150}, {1e-100}, 1e-15);
  ExpectRoots({1e-150, 0, 0, 1e150}, {-1e100}, 1e-15);
  ExpectRoots({1e-150, -1e150, 1, 0}, {0, 1e-150, 1e300}, 1e-15);
  // The root -1e400 is left out.
  ExpectRoots({1e-200, 1e200, 0, -1e200}, {-1, 1}, 1e-15);
  // Denormal coefficients.
  ExpectRoots({5e-324, 0, 0, -5e-324 * 8}, {2});
}

TEST(Cubic, RootsOfVeryDifferentMagnitude) {
  // (x - 1e-100)(x - 1)(x - 1e100), each coefficient rounded.
  ExpectRoots({1, -1e100, 1e100, -1}, {1e-100, 1, 1e100}, 1e-15);
  // (x + 1e-8)(x - 1)(x - 1e8): 1e8 - 1 of x, -1e8 - 1 + 1e-8 of x^2.
  ExpectSound({1, -100000000.99999999, 99999998.99999999, 1});
}

TEST(Cubic, RandomRoots) {
  Random random(1);
  for (int trial = 0; trial < (kSanitized ? 2000 : 10'000); ++trial) {
    const double range = random.Uniform(0, 60);  // decades
    std::array<long double, 3> r{};
    for (long double& root : r) {
      root = std::pow(10.0, random.Uniform(-range, range)) * (random.Uniform() < 0.5 ? -1 : 1);
    }
    const int kind = trial % 4;
    if (kind == 1) r[1] = r[0];                                      // double, nearly
    if (kind == 2) r[1] = r[0] * (1 + random.Uniform(1e-12, 1e-3));  // close
    if (kind == 3 && trial % 8 == 3) r[1] = r[2] = r[0];             // triple, nearly
    const long double a = std::pow(10.0, random.Uniform(-60, 60));
    const Coefficients p{static_cast<double>(a), static_cast<double>(-a * (r[0] + r[1] + r[2])),
                         static_cast<double>(a * (r[0] * r[1] + r[1] * r[2] + r[2] * r[0])),
                         static_cast<double>(-a * r[0] * r[1] * r[2])};
    ASSERT_NO_FATAL_FAILURE(ExpectSound(p));

    std::ranges::sort(r);
    const auto apart = [](long double x, long double y) {
      return y - x > 1e-3L * std::max(std::abs(x), std::abs(y));
    };
    // Cancellation in the coefficients of roots of opposite sign moves roots: leave it out.
    const bool one_sign = r[0] > 0 || r[2] < 0;
    if (!one_sign || !apart(r[0], r[1]) || !apart(r[1], r[2])) continue;
    const std::vector<double> roots = Roots(p);
    ASSERT_EQ(roots.size(), 3U) << p.Text();
    for (int k = 0; k < 3; ++k) {
      const auto expected = static_cast<double>(r[k]);
      // Conditioning: 8 rounding errors over the product of two relative distances.
      ASSERT_NEAR(roots[k], expected, 8e-16 / 1e-6 * std::abs(expected)) << p.Text();
    }
  }
}

TEST(Cubic, RandomCoefficients) {
  Random random(2);
  for (int trial = 0; trial < (kSanitized ? 2000 : 10'000); ++trial) {
    const double range = trial % 2 == 0 ? 2 : 150;  // decades
    const auto draw = [&] {
      const double magnitude = std::pow(10.0, random.Uniform(-range, range));
      const double kind = random.Uniform();
      return kind < 0.1 ? 0 : kind < 0.55 ? magnitude : -magnitude;
    };
    const double a = draw(), b = draw(), c = draw(), d = draw();
    const Coefficients p{a, b, c, d};
    if (a == 0 && b == 0 && c == 0) continue;
    ASSERT_NO_FATAL_FAILURE(ExpectSound(p));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
