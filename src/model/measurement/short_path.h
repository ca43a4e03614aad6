#ifndef TRILOBE_MODEL_MEASUREMENT_SHORT_PATH_H_
#define TRILOBE_MODEL_MEASUREMENT_SHORT_PATH_H_

#include <array>
#include <vector>

#include "trilobe/core/base/directions.h"

namespace trilobe {

// What a goniometer takes to go from one pair of directions to the next: its axes move one after
// the other.
struct AxisCosts {
  std::array<double, 3> of_radian = {1, 1, 1};  // of theta_i, of theta_o, of phi_o - phi_i
  // The detector stays in the plane of incidence, and goes from one side to the other through the
  // normal.
  bool in_plane = false;
};

// Throws Error unless they are finite and at least 0.
void CheckAxisCosts(const AxisCosts& costs);

inline constexpr int kMostOfPath = 2000;

// What it takes to go through all of them in this order.
double PathCost(const std::vector<SphericalAngles>& directions, const AxisCosts& costs);

// The same directions in an order that takes little, from the first one on: always to the nearest,
// and then parts of the way turned round while that makes it shorter (2-opt, Croes 1958). Never
// dearer than as they are. Throws Error for more than kMostOfPath, and as CheckAxisCosts.
std::vector<SphericalAngles> AlongShortPath(std::vector<SphericalAngles> directions,
                                            const AxisCosts& costs);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_SHORT_PATH_H_
