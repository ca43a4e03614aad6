#include "trilobe/model/brdf_table.h"

#include <cmath>

namespace trilobe {

BrdfTable MakeInvalidTable(const std::string& source, const MerlGrid& grid) {
  BrdfTable table{source, grid, {}};
  for (auto& plane : table.stored) plane.assign(grid.size(), -1.0);
  return table;
}

std::vector<bool> BinsAboveSurface(const MerlGrid& grid) {
  std::vector<bool> above(grid.size());
  for (int bin = 0; bin < grid.size(); ++bin) {
    const auto [cos_i, cos_o] = ToCosines(grid.Center(bin));
    above[bin] = cos_i > 0 && cos_o > 0;
  }
  return above;
}

std::vector<bool> ValidBins(const BrdfTable& table) {
  std::vector<bool> valid = BinsAboveSurface(table.grid);
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    for (const auto& plane : table.stored) {
      if (!(std::isfinite(plane[bin]) && plane[bin] >= 0)) valid[bin] = false;
    }
  }
  return valid;
}

}  // namespace trilobe
