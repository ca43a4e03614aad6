#ifndef TRILOBE_IO_FORMATS_DATABASES_RGL_MASK_H_
#define TRILOBE_IO_FORMATS_DATABASES_RGL_MASK_H_

#include <cstdint>
#include <vector>

#include "io/formats/databases/bilinear_warp.h"
#include "io/formats/databases/tensor_file.h"

namespace trilobe {

// Nodes of an RGL file's field `rgb` that the authors measured, and those that they filled
// (docs/your-data.md).
class RglMask {
 public:
  // For a file whose `rgb` has `rgb_slices` = phi_i x theta_i slices of these rows and columns.
  // Without the field `valid` all nodes count as measured. Throws Error if the shape of the field
  // differs, or if it is ambiguous which of its two values means measured.
  RglMask(const TensorFile& file, const std::vector<double>& theta_i, int rgb_slices, int rows,
          int columns);

  // The largest measured theta_i, at most 90 degrees [rad].
  double max_theta() const { return max_theta_; }

  // Whether all nodes with nonzero weight in a blend of slices at a point were measured.
  bool Measured(const SliceBlend& blend, const SquarePoint& point) const;

 private:
  int rows_, columns_;
  double max_theta_;
  std::vector<bool> measured_;  // [slices][rows][columns]; empty: all
  // Whether all four nodes of a cell are measured, at its first node, to speed up most lookups.
  std::vector<uint8_t> cell_measured_;
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_DATABASES_RGL_MASK_H_
