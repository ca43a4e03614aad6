#include "core/base/grid_cosines.h"

#include <cmath>

namespace trilobe {

GridCosines::GridCosines(const MerlGrid& grid) : grid_(grid) {
  CheckGrid(grid);
  const auto angle = [](double x) { return Angle{std::sin(x), std::cos(x)}; };
  for (int h = 0; h < grid.theta_h; ++h) h_.push_back(angle(grid.Center(h, 0, 0).theta_h));
  for (int d = 0; d < grid.theta_d; ++d) d_.push_back(angle(grid.Center(0, d, 0).theta_d));
  for (int p = 0; p < grid.phi_d; ++p) cos_phi_.push_back(std::cos(grid.Center(0, 0, p).phi_d));
}

}  // namespace trilobe
