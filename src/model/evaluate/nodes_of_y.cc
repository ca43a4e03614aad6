#include "model/evaluate/nodes_of_y.h"

#include <cmath>

#include "trilobe/core/math/angles.h"

namespace trilobe {

std::vector<double> NodesOfY(const ModelSpec& spec) {
  const Axis& d_axis = spec.d_axis;
  std::vector<double> theta = {0};
  if (d_axis.polar()) {
    constexpr int kSteps = 4;
    std::vector<double> rings = d_axis.theta;
    if (rings.front() > 0) rings.insert(rings.begin(), 0);
    rings.push_back(90);
    for (size_t a = 1; a < rings.size(); ++a) {
      for (int k = 1; k <= kSteps; ++k) {
        const double degrees = rings[a - 1] + (rings[a] - rings[a - 1]) * k / kSteps;
        theta.push_back(DegreesToRadians(degrees));
      }
    }
  } else {
    // Halves of bins of sqrt(theta), less where a stretch makes these narrower.
    const int steps = (spec.stretches.any() ? 4 : 2) * d_axis.size;
    for (int k = 1; k <= steps; ++k) {
      const double x = static_cast<double>(k) / steps;
      theta.push_back(x * x * kPi / 2);
    }
  }
  std::vector<double> y;
  for (const double t : theta) y.push_back(std::sin(t) * std::sin(t));
  y.back() = 1;
  return y;
}

}  // namespace trilobe
