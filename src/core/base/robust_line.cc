#include "core/base/robust_line.h"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/quantile.h"
#include "trilobe/core/base/angles.h"

namespace trilobe {
RobustLine FitRobustLine(std::span<const double> x, std::span<const double> y) {
  std::vector<double> slopes, heights;
  for (size_t k = 0; k < x.size(); ++k) {
    for (size_t l = k + 1; l < x.size(); ++l) slopes.push_back((y[l] - y[k]) / (x[l] - x[k]));
  }
  const double slope = UpperMedian(std::move(slopes));
  for (size_t k = 0; k < x.size(); ++k) heights.push_back(y[k] - slope * x[k]);
  return {.slope = slope, .at_zero = UpperMedian(std::move(heights))};
}

double LevelledOff(const RobustLine& line, double from, double x) {
  constexpr double kLength = DegreesToRadians(20);
  return line(from) + line.slope * kLength * std::tanh((x - from) / kLength);
}

}  // namespace trilobe
