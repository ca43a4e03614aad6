#include "trilobe/core/base/merl_grid.h"

#include <limits>
#include <string>

#include "trilobe/core/base/error.h"

namespace trilobe {

void CheckGrid(const MerlGrid& grid) {
  const double size = 1.0 * grid.theta_h * grid.theta_d * grid.phi_d;
  if (grid.theta_h > 0 && grid.theta_d > 0 && grid.phi_d > 0 &&
      size <= std::numeric_limits<int>::max()) {
    return;
  }
  throw Error(ErrorKind::kRange,
              "a grid of " + std::to_string(grid.theta_h) + " x " + std::to_string(grid.theta_d) +
                  " x " + std::to_string(grid.phi_d) +
                  " bins; it needs at least one of each, and no more than 2^31 - 1 in all")
      .About("grid of bins");
}

}  // namespace trilobe
