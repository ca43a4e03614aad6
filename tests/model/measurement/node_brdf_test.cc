#include "trilobe/model/measurement/node_brdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

NodeTable RandomTable(int thetas, int phis) {
  NodeTable table{.source = "random", .grid = {thetas, phis}, .rho = {}, .present = {}};
  const size_t pairs = static_cast<size_t>(table.grid.nodes()) * table.grid.nodes();
  Random random(4);
  for (size_t k = 0; k < pairs; ++k) {
    table.rho.push_back({random.Uniform(), random.Uniform(), random.Uniform()});
  }
  table.present.assign(pairs, true);
  table.max_theta = (thetas - 1) * table.grid.ThetaStep();
  return table;
}

void ExpectNear(const Rgb& a, const Rgb& b) {
  for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(a[c], b[c], 1e-12);
}

TEST(NodeBrdf, IsTheTableAtNodesWhateverTheTurn) {
  const NodeTable table = RandomTable(4, 5);
  const NodeBrdf brdf(table);
  for (int i = 0; i < table.grid.nodes(); ++i) {
    for (int o = 0; o < table.grid.nodes(); ++o) {
      SphericalAngles at = table.grid.Angles(i, o);
      const Rgb& rho = table.rho[static_cast<size_t>(i) * table.grid.nodes() + o];
      ExpectNear(brdf(at), rho);
      at.phi_i -= 2 * kPi;
      at.phi_o += 6 * kPi;
      ExpectNear(brdf(at), rho);
      EXPECT_TRUE(brdf.Measured(at));
    }
  }
}

// Against the sum over all nodes of tent functions, which between two nodes is the same.
TEST(NodeBrdf, IsLinearInEachAngleAndConstantBeyondTheLastTheta) {
  const NodeTable table = RandomTable(3, 7);
  const NodeBrdf brdf(table);
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const SphericalAngles at = {random.Uniform(0, 1.57), random.Uniform(-9, 9),
                                random.Uniform(0, 1.57), random.Uniform(-9, 9)};
    const auto weight = [&](int node, double theta, double phi) {
      const int ring = node / 7;
      const double place = std::min(theta / table.grid.ThetaStep(), 2.0);
      const double turn = std::remainder(phi - node % 7 * table.grid.PhiStep(), 2 * kPi);
      return std::max(0.0, 1 - std::abs(place - ring)) *
             std::max(0.0, 1 - std::abs(turn) / table.grid.PhiStep());
    };
    Rgb sum{};
    for (int i = 0; i < table.grid.nodes(); ++i) {
      for (int o = 0; o < table.grid.nodes(); ++o) {
        const double w = weight(i, at.theta_i, at.phi_i) * weight(o, at.theta_o, at.phi_o);
        for (int c = 0; c < kChannels; ++c) {
          sum[c] += w * table.rho[static_cast<size_t>(i) * table.grid.nodes() + o][c];
        }
      }
    }
    ExpectNear(brdf(at), sum);
    EXPECT_EQ(brdf.Measured(at), std::max(at.theta_i, at.theta_o) <= table.max_theta);
  }
}

TEST(NodeBrdf, FillsWhatIsMissingFromTheNearest) {
  NodeTable table = RandomTable(3, 6);
  const int i = 7, o = 15;  // theta, phi = 1, 1 and 2, 3
  const auto index = [&](int a, int b) { return static_cast<size_t>(a) * table.grid.nodes() + b; };
  // All about (i, o) within two steps, but for one pair two steps away.
  for (int k = 0; k < table.grid.nodes(); ++k) {
    for (int l = 0; l < table.grid.nodes(); ++l) table.present[index(k, l)] = false;
  }
  table.present[index(i + 1, o - 6)] = true;
  table.present[index(0, 0)] = true;
  const NodeBrdf brdf(table);
  ExpectNear(brdf(table.grid.Angles(i, o)), table.rho[index(i + 1, o - 6)]);
  EXPECT_FALSE(brdf.Measured(table.grid.Angles(i, o)));
  EXPECT_TRUE(brdf.Measured(table.grid.Angles(i + 1, o - 6)));
  ExpectNear(brdf(table.grid.Angles(5, 5)), table.rho[index(0, 0)]);  // around the turn
  EXPECT_FALSE(brdf.MeasuredAround(0, 0));
}

TEST(NodeBrdf, KnowsWhereAllNodesAroundAreMeasured) {
  NodeTable table = RandomTable(3, 4);
  table.present[static_cast<size_t>(5) * table.grid.nodes() + 6] = false;  // thetas 1, phis 1 and 2
  const NodeBrdf brdf(table);
  EXPECT_FALSE(brdf.MeasuredAround(0, 1));
  EXPECT_FALSE(brdf.MeasuredAround(5, 6));
  EXPECT_TRUE(brdf.MeasuredAround(6, 6));
  EXPECT_TRUE(brdf.MeasuredAround(7, 7));   // whose neighbours in phi are at 0
  EXPECT_FALSE(brdf.MeasuredAround(8, 7));  // nothing beyond the last theta
}

TEST(NodeBrdf, WantsAValueForEachPair) {
  NodeTable table = RandomTable(2, 3);
  table.rho.pop_back();
  EXPECT_THAT(ErrorOf([&] { NodeBrdf{table}; }),
              IsError(ErrorKind::kMismatch, {.file = "random", .key = "rho", .value = "35"}));
  table = RandomTable(2, 3);
  table.present.assign(table.present.size(), false);
  EXPECT_THAT(ErrorOf([&] { NodeBrdf{table}; }), IsError(ErrorKind::kData, {.key = "present"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
