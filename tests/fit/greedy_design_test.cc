#include "fit/greedy_design.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "core/base/radical_inverse.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr int kCandidates = 12, kUnknowns = 5, kSeen = 7;

// Numbers from -1 to 1 without a pattern.
Eigen::MatrixXd Numbers(int rows, int columns, int base) {
  Eigen::MatrixXd numbers(rows, columns);
  for (int k = 0; k < rows * columns; ++k) {
    numbers(k / columns, k % columns) = 2 * RadicalInverse(base, k + 1) - 1;
  }
  return numbers;
}

const Eigen::MatrixXd& Reads() {
  static const Eigen::MatrixXd reads = Numbers(kCandidates * kChannels, kUnknowns, 7);
  return reads;
}
const Eigen::MatrixXd& Seen() {
  static const Eigen::MatrixXd seen = Numbers(kSeen, kUnknowns, 11);
  return seen;
}

// The trace of seen (I + X'X)^-1 seen', X the rows of what was measured.
double Literal(const std::vector<int>& measured) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(kUnknowns, kUnknowns);
  for (const int c : measured) {
    const Eigen::MatrixXd rows = Reads().middleRows(kChannels * c, kChannels);
    information += rows.transpose() * rows;
  }
  return (Seen() * information.inverse() * Seen().transpose()).trace();
}

TEST(GreedyDesign, IsTheTraceOfTheInverse) {
  GreedyDesign design(Reads(), Seen());
  EXPECT_NEAR(design.variance(), Literal({}), 1e-12);
  std::vector<int> measured;
  for (const int c : {3, 0, 8, 11}) {
    const double gain = design.Gain(c);
    design.Measure(c);
    measured.push_back(c);
    EXPECT_NEAR(design.variance(), Literal(measured), 1e-12);
    measured.pop_back();
    EXPECT_NEAR(gain, Literal(measured) - design.variance(), 1e-12);
    measured.push_back(c);
  }
}

TEST(GreedyDesign, TakesWhatLowersItMost) {
  GreedyDesign design(Reads(), Seen());
  std::vector<int> measured;
  for (int step = 0; step < kCandidates; ++step) {
    int best = -1;
    double least = 0;
    for (int c = 0; c < kCandidates; ++c) {
      if (std::ranges::find(measured, c) != measured.end()) continue;
      std::vector<int> with = measured;
      with.push_back(c);
      if (const double variance = Literal(with); best < 0 || variance < least) {
        best = c;
        least = variance;
      }
    }
    ASSERT_EQ(design.Best(), best) << step;
    design.Measure(best);
    measured.push_back(best);
  }
  EXPECT_EQ(design.Best(), -1);
  EXPECT_EQ(design.First(), -1);
}

// What a measurement tells becomes less by others before it, and is never below 0.
TEST(GreedyDesign, GainsAreNotNegativeAndDecrease) {
  GreedyDesign design(Reads(), Seen());
  double before = design.variance();
  for (int best = design.Best(); best >= 0; best = design.Best()) {
    const double gain = design.Gain(best);
    EXPECT_GE(gain, 0);
    EXPECT_LE(gain, before);
    before = gain;
    design.Measure(best);
  }
}

TEST(GreedyDesign, WithoutGainTheFirstComesFirst) {
  GreedyDesign design(Eigen::MatrixXd::Zero(4 * kChannels, 3), Eigen::MatrixXd::Identity(3, 3));
  for (const int c : {0, 1, 2, 3}) {
    EXPECT_EQ(design.First(), c);
    EXPECT_EQ(design.Best(), c);
    design.Measure(c);
  }
  EXPECT_EQ(design.variance(), 3);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
