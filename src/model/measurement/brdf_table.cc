#include "trilobe/model/measurement/brdf_table.h"

#include <algorithm>
#include <cmath>

#include "core/base/grid_cosines.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

void CheckTable(const BrdfTable& table) {
  CheckGrid(table.grid);
  const auto size = static_cast<size_t>(table.grid.size());
  for (const auto& plane : table.stored) {
    if (plane.size() == size) continue;
    throw ErrorIn(ErrorKind::kMismatch, table.source,
                  "a channel has " + std::to_string(plane.size()) + " values, but the grid " +
                      std::to_string(size) + " bins")
        .About("stored", plane.size());
  }
  if (!table.unmeasured.empty() && table.unmeasured.size() != size) {
    throw ErrorIn(ErrorKind::kMismatch, table.source,
                  std::to_string(table.unmeasured.size()) +
                      " bins are marked as measured or not, but the grid has " +
                      std::to_string(size))
        .About("unmeasured", table.unmeasured.size());
  }
}

BrdfTable MakeInvalidTable(const std::string& source, const MerlGrid& grid) {
  CheckGrid(grid);
  BrdfTable table{source, grid, {}, {}};
  for (auto& plane : table.stored) plane.assign(grid.size(), -1.0);
  return table;
}

std::vector<bool> BinsAboveSurface(const MerlGrid& grid) {
  const GridCosines cosines(grid);
  std::vector<bool> above(grid.size());
  int bin = 0;
  for (int h = 0; h < grid.theta_h; ++h) {
    for (int d = 0; d < grid.theta_d; ++d) {
      for (int p = 0; p < grid.phi_d; ++p, ++bin) {
        const auto [cos_i, cos_o] = cosines(h, d, p);
        above[bin] = cos_i > 0 && cos_o > 0;
      }
    }
  }
  return above;
}

std::vector<bool> ValidBins(const BrdfTable& table) {
  CheckTable(table);
  std::vector<bool> valid = BinsAboveSurface(table.grid);
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    for (const auto& plane : table.stored) {
      if (!(std::isfinite(plane[bin]) && plane[bin] >= 0)) valid[bin] = false;
    }
    if (ReasonOf(table, bin) != Unmeasured::kNo) valid[bin] = false;
  }
  return valid;
}

double MaxAngleDegrees(double max_theta) {
  constexpr double kDigits = 1e9;
  return std::round(RadiansToDegrees(max_theta) * kDigits) / kDigits;
}

double MaxAngleDegrees(const BrdfTable& table) { return MaxAngleDegrees(table.max_theta); }

void LimitAngles(double max_theta, Unmeasured reason, BrdfTable* table) {
  CheckTable(NotNull(table, "the table"));
  if (!(max_theta >= 0)) {
    throw Error(ErrorKind::kRange, "the largest angle must be a number of 0 or more")
        .About("max_theta", max_theta);
  }
  if (max_theta >= table->max_theta) return;  // 90 degrees, say: nothing more to leave out
  table->max_theta = max_theta;
  table->unmeasured.resize(table->grid.size(), Unmeasured::kNo);
  const double min_cosine = std::cos(max_theta);
  const GridCosines cosines(table->grid);
  for (int bin = 0; bin < table->grid.size(); ++bin) {
    const auto [cos_i, cos_o] = cosines(bin);
    const bool above_surface = cos_i > 0 && cos_o > 0;
    const bool beyond = std::min(cos_i, cos_o) < min_cosine;
    Unmeasured& why = table->unmeasured[bin];
    if (above_surface && beyond && why == Unmeasured::kNo) why = reason;
  }
}

void LimitThetaD(double min_theta_d, BrdfTable* table) {
  CheckTable(NotNull(table, "the table"));
  if (std::isnan(min_theta_d)) {
    throw Error(ErrorKind::kRange, "the smallest theta_d must be a number")
        .About("min_theta_d", min_theta_d);
  }
  if (!(min_theta_d > 0)) return;
  const std::vector<bool> above = BinsAboveSurface(table->grid);
  table->unmeasured.resize(table->grid.size(), Unmeasured::kNo);
  for (int bin = 0; bin < table->grid.size(); ++bin) {
    Unmeasured& why = table->unmeasured[bin];
    const bool below = table->grid.Center(bin).theta_d < min_theta_d;
    if (above[bin] && below && why == Unmeasured::kNo) why = Unmeasured::kBelowMinThetaD;
  }
}

}  // namespace trilobe
