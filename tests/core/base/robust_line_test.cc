#include "core/base/robust_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trilobe/core/base/angles.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(RobustLine, IsTheLineOfMostPoints) {
  const std::vector<double> x = {0, 1, 2, 4, 5, 7, 8, 9};
  std::vector<double> y;
  for (const double at : x) y.push_back(3 - 2 * at);
  y[6] = 40;  // two that are wrong
  y[7] = 60;
  const RobustLine line = FitRobustLine(x, y);
  EXPECT_NEAR(line.slope, -2, 1e-12);
  EXPECT_NEAR(line.at_zero, 3, 1e-12);
  EXPECT_NEAR(line(10), -17, 1e-11);
}

TEST(RobustLine, LevelsOffOverTwentyDegrees) {
  const RobustLine line = {.slope = 4, .at_zero = 1};
  const double length = DegreesToRadians(20);
  EXPECT_EQ(LevelledOff(line, 0.5, 0.5), 3);
  EXPECT_NEAR(LevelledOff(line, 0.5, 0.501), line(0.501), 1e-6);  // with the slope of the line
  EXPECT_NEAR(LevelledOff(line, 0.5, 100), 3 + 4 * length, 1e-12);
  EXPECT_NEAR(LevelledOff(line, 0.5, 0.5 + length), 3 + 4 * length * std::tanh(1), 1e-12);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
