#include "io/formats/databases/rgl_mask.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "trilobe/core/base/directions.h"

namespace trilobe {
namespace {

constexpr const char* kField = "valid";

// Nodes of theta_i from here on [rad] stand at the horizon, where light cannot fall on a sample.
// They are float32, so 90 degrees need not be kPi / 2.
constexpr double kHorizon = kPi / 2 - 1e-4;

// Share of the first column that must agree on which bit means measured.
constexpr double kNearlyAll = 0.9;

// The bits of the field, the most significant of each byte first.
std::vector<bool> ReadBits(const TensorFile& file, size_t count) {
  const std::string_view bytes = file.Bytes(kField);
  if (bytes.size() != (count + 7) / 8) {
    file.Fail(kField,
              "has " + std::to_string(bytes.size()) + " bytes; it must have " +
                  std::to_string((count + 7) / 8) + ", a bit for each of the " +
                  std::to_string(count) + " nodes that rgb has for each channel",
              ErrorKind::kMismatch, std::to_string(bytes.size()));
  }
  std::vector<bool> bits(count);
  for (size_t i = 0; i < count; ++i) {
    bits[i] = (static_cast<uint8_t>(bytes[i / 8]) >> (7 - i % 8) & 1) != 0;
  }
  return bits;
}

}  // namespace

RglMask::RglMask(const TensorFile& file, const std::vector<double>& theta_i, int rgb_slices,
                 int rows, int columns)
    : rows_(rows), columns_(columns), max_theta_(std::min(theta_i.back(), kPi / 2)) {
  if (!file.Has(kField)) return;
  const auto nodes = static_cast<int>(theta_i.size());
  // Nodes at the horizon are none that the field speaks of, whatever its bits are there.
  const auto below_horizon =
      static_cast<int>(std::ranges::lower_bound(theta_i, kHorizon) - theta_i.begin());
  if (below_horizon == 0) {
    file.Fail("theta_i", "has no node below 90 degrees, so nothing was measured", ErrorKind::kData);
  }
  max_theta_ = theta_i[below_horizon - 1];
  measured_ = ReadBits(file, static_cast<size_t>(rgb_slices) * rows * columns);
  const auto first_of_row = [&](int slice, int row) { return (slice * rows + row) * columns; };

  // Some files have 1 for measured, others 0. The first column of rgb, its innermost theta, is
  // measured in every row.
  int ones = 0, all = 0;
  for (int slice = 0; slice < rgb_slices; ++slice) {
    if (slice % nodes >= below_horizon) continue;
    for (int row = 0; row < rows; ++row, ++all) ones += measured_[first_of_row(slice, row)] ? 1 : 0;
  }
  if (std::max(ones, all - ones) < kNearlyAll * all) {
    file.Fail(kField, "has " + std::to_string(ones) + " ones among the " + std::to_string(all) +
                          " entries of the first column; measured in every row, it must be nearly "
                          "all 1 or nearly all 0 to tell which of them means measured");
  }
  if (2 * ones < all) measured_.flip();
  for (int slice = 0; slice < rgb_slices; ++slice) {
    if (slice % nodes < below_horizon) continue;
    std::fill_n(measured_.begin() + first_of_row(slice, 0), rows * columns, false);
  }
  cell_measured_.assign(measured_.size(), 0);
  for (int slice = 0; slice < rgb_slices; ++slice) {
    for (int row = 0; row + 1 < rows; ++row) {
      for (int column = 0; column + 1 < columns; ++column) {
        const int node = first_of_row(slice, row) + column;
        cell_measured_[node] = measured_[node] && measured_[node + 1] &&
                                       measured_[node + columns] && measured_[node + columns + 1]
                                   ? 1
                                   : 0;
      }
    }
  }
}

bool RglMask::Measured(const SliceBlend& blend, const SquarePoint& point) const {
  if (measured_.empty()) return true;
  const auto [row, v] = LocateNode(point.y, rows_);
  const auto [column, u] = LocateNode(point.x, columns_);
  for (int k = 0; k < blend.count; ++k) {
    if (!(blend.weight[k] > 0)) continue;
    const int node = (blend.slice[k] * rows_ + row) * columns_ + column;
    if (cell_measured_[node] != 0) continue;
    const auto read = [&](double weight, int at) { return !(weight > 0) || measured_[at]; };
    if (!(read((1 - u) * (1 - v), node) && read(u * (1 - v), node + 1) &&
          read((1 - u) * v, node + columns_) && read(u * v, node + columns_ + 1))) {
      return false;
    }
  }
  return true;
}

}  // namespace trilobe
