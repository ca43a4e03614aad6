#include "trilobe/core/base/catmull_rom.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/test_util.h"
#include "trilobe/core/base/directions.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

const std::vector<double> kValues = {1, 2, 4, 3, 7};

double At(const std::vector<double>& values, int interval, double t) {
  const CatmullRom spline(static_cast<int>(values.size()));
  return spline.StencilAt({interval, t})(values);
}

// f(t) = f0 (2t^3-3t^2+1) + f1 (3t^2-2t^3) + m0 (t^3-2t^2+t) + m1 (t^3-t^2), with inner slopes
// (f_{k+1} - f_{k-1})/2 and one-sided slopes at the two ends. At t = 1/2 this is
// (f0+f1)/2 + (m0-m1)/8; at t = 1/4 it is (54 f0 + 10 f1 + 9 m0 - 3 m1)/64.
TEST(CatmullRom, ByHand) {
  // Slopes at the nodes: 1 (one-sided), 1.5, 0.5, 1.5, 4 (one-sided).
  EXPECT_DOUBLE_EQ(At(kValues, 0, 0.5), 1.4375);  // 1.5 + (1 - 1.5)/8
  EXPECT_DOUBLE_EQ(At(kValues, 1, 0.5), 3.125);   // 3 + (1.5 - 0.5)/8
  EXPECT_DOUBLE_EQ(At(kValues, 2, 0.5), 3.375);   // 3.5 + (0.5 - 1.5)/8
  EXPECT_DOUBLE_EQ(At(kValues, 3, 0.5), 4.6875);  // 5 + (1.5 - 4)/8
  EXPECT_DOUBLE_EQ(At(kValues, 0, 0.25), 1.2265625);
  EXPECT_DOUBLE_EQ(At(kValues, 1, 0.25), 2.5);
  EXPECT_DOUBLE_EQ(At(kValues, 2, 0.25), 3.84375);
  EXPECT_DOUBLE_EQ(At(kValues, 3, 0.25), 3.6484375);
}

TEST(CatmullRom, WeightsByHand) {
  const CatmullRom spline(5);
  using Weights = std::array<double, 4>;
  EXPECT_EQ(spline.Weights({1, 0.5}), (Weights{-0.0625, 0.5625, 0.5625, -0.0625}));
  EXPECT_EQ(spline.Weights({0, 0.5}), (Weights{0, 0.4375, 0.625, -0.0625}));
  EXPECT_EQ(spline.Weights({3, 0.5}), (Weights{-0.0625, 0.625, 0.4375, 0}));
  EXPECT_EQ(spline.Weights({2, 0.25}), (Weights{-0.0703125, 0.8671875, 0.2265625, -0.0234375}));
}

TEST(CatmullRom, InterpolatesTheNodes) {
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(At(kValues, k, 0), kValues[k]);
    EXPECT_EQ(At(kValues, k, 1), kValues[k + 1]);
  }
}

TEST(CatmullRom, NodesAreAtHalfDegrees) {
  const CatmullRom spline(90);
  EXPECT_NEAR(RadiansToDegrees(spline.NodeAngle(0)), 0.5, 1e-14);
  EXPECT_NEAR(RadiansToDegrees(spline.NodeAngle(89)), 89.5, 1e-12);
  EXPECT_NEAR(RadiansToDegrees(CatmullRom(6).NodeAngle(1)), 22.5, 1e-13);
}

TEST(CatmullRom, LocatesAngles) {
  const CatmullRom spline(90);
  const auto [interval, t] = spline.Locate(DegreesToRadians(41.75));
  EXPECT_EQ(interval, 41);
  EXPECT_NEAR(t, 0.25, 1e-12);
  EXPECT_EQ(spline.Locate(0).interval, 0);
  EXPECT_EQ(spline.Locate(0).t, 0);
  EXPECT_EQ(spline.Locate(kPi / 2).interval, 88);
  EXPECT_EQ(spline.Locate(kPi / 2).t, 1);
}

TEST(CatmullRom, PartitionOfUnity) {
  for (const int nodes : {4, 5, 90}) {
    const CatmullRom spline(nodes);
    for (double degrees = 0; degrees <= 90; degrees += 0.1) {
      const Stencil stencil = spline.StencilAt(DegreesToRadians(degrees));
      double sum = 0;
      for (int k = 0; k < stencil.size; ++k) {
        EXPECT_GE(stencil.index[k], 0);
        EXPECT_LT(stencil.index[k], nodes);
        sum += stencil.weight[k];
      }
      EXPECT_NEAR(sum, 1, 1e-15);
    }
  }
}

TEST(CatmullRom, ExactOnLinesBetweenTheEndNodes) {
  for (const int nodes : {4, 5, 90}) {
    const CatmullRom spline(nodes);
    std::vector<double> line(nodes);
    for (int k = 0; k < nodes; ++k) line[k] = 3 - 1.5 * spline.NodeAngle(k);
    const double first = spline.NodeAngle(0), last = spline.NodeAngle(nodes - 1);
    for (int n = 0; n <= 1000; ++n) {
      const double theta = first + (last - first) * n / 1000;
      EXPECT_NEAR(spline.StencilAt(theta)(line), 3 - 1.5 * theta, 1e-14);
    }
  }
}

TEST(CatmullRom, ConstantOutsideTheEndNodes) {
  const CatmullRom spline(5);
  for (const double inwards : {0.0, 0.3, 0.999}) {
    EXPECT_EQ(spline.StencilAt(inwards * spline.NodeAngle(0))(kValues), 1);
    EXPECT_EQ(spline.StencilAt(kPi / 2 - inwards * spline.NodeAngle(0))(kValues), 7);
  }
}

TEST(CatmullRom, IsContinuouslyDifferentiable) {
  const std::vector<CatmullRom::Piece> pieces = CatmullRom(5).Pieces(kValues);
  constexpr double kStep = 1e-6;
  const auto slope = [&](int k, double v) {
    return (pieces[k](v + kStep) - pieces[k](v - kStep)) / (2 * kStep);
  };
  ASSERT_EQ(pieces.size(), 4U);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(pieces[k](0.5), pieces[k + 1](-0.5));
    EXPECT_NEAR(slope(k, 0.5), slope(k + 1, -0.5), 1e-9);
  }
  EXPECT_NEAR(slope(0, -0.5), 1, 1e-9);  // the one-sided slopes
  EXPECT_NEAR(slope(3, 0.5), 4, 1e-9);
  // The same to rounding, from the derivative of a piece at its ends.
  const auto first_slope = [](const CatmullRom::Piece& p) { return p.f1 - p.f0 + p.a0; };
  const auto last_slope = [](const CatmullRom::Piece& p) { return p.f1 - p.f0 - p.a1; };
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(last_slope(pieces[k]), first_slope(pieces[k + 1]), 1e-14);
  }
  EXPECT_NEAR(first_slope(pieces[0]), 1, 1e-14);
  EXPECT_NEAR(last_slope(pieces[3]), 4, 1e-14);
}

TEST(CatmullRom, PolynomialsAndPiecesAgreeWithWeights) {
  for (const int nodes : {4, 5, 90}) {
    const CatmullRom spline(nodes);
    Random random(1);
    std::vector<double> values(nodes);
    for (double& value : values) value = random.LogNormal(1);
    const std::vector<CatmullRom::Piece> pieces = spline.Pieces(values);
    ASSERT_EQ(pieces.size(), static_cast<size_t>(nodes - 1));
    for (int interval = 0; interval < nodes - 1; ++interval) {
      const auto polynomials = spline.WeightPolynomials(interval);
      for (double t = 0; t <= 1; t += 0.125) {
        const double u = 1 - t;
        const auto weights = spline.Weights({interval, t});
        for (int a = 0; a < 4; ++a) {
          const auto& c = polynomials[a];
          const double weight =
              c[0] * u * u * u + c[1] * t * u * u + c[2] * t * t * u + c[3] * t * t * t;
          EXPECT_NEAR(weight, weights[a], 1e-15);
        }
        EXPECT_NEAR(pieces[interval](t - 0.5), spline.StencilAt({interval, t})(values), 1e-13);
      }
    }
  }
}

// Small values beside large ones keep their digits.
TEST(CatmullRom, PiecesAreExactAtTheNodes) {
  const std::vector<double> values = {4.4e-11, 1, 0, 1e20, 3e-30};
  const std::vector<CatmullRom::Piece> pieces = CatmullRom(5).Pieces(values);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(pieces[k](-0.5), values[k]);
    EXPECT_EQ(pieces[k](0.5), values[k + 1]);
  }
}

// docs/model.md: the splined cosine divides; it never falls below that of the last node.
TEST(CatmullRom, SplinedCosineStaysAboveThatOfTheLastNode) {
  const CatmullRom spline(90);
  std::vector<double> cosines(90);
  for (int k = 0; k < 90; ++k) cosines[k] = std::cos(spline.NodeAngle(k));
  const double least = std::cos(DegreesToRadians(89.5));
  for (int n = 0; n <= 90'000; ++n) {
    const double theta = DegreesToRadians(n * 1e-3);
    const double splined = spline.StencilAt(theta)(cosines);
    ASSERT_GE(splined, least * (1 - 1e-13)) << n * 1e-3;
    if (n >= 500 && n <= 89'500) {
      // One-sided end slopes err by (node distance)^2 there; inside it is of fourth order.
      ASSERT_NEAR(splined, std::cos(theta), n < 1500 || n > 88'500 ? 3e-5 : 1e-7) << n * 1e-3;
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
