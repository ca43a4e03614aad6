#ifndef TRILOBE_IO_FORMATS_RGL_MASK_H_
#define TRILOBE_IO_FORMATS_RGL_MASK_H_

#include <cstdint>
#include <vector>

#include "io/formats/bilinear_warp.h"
#include "io/formats/tensor_file.h"

namespace trilobe {

// Which nodes of an RGL file's field `rgb` the authors measured, and which they filled
// (docs/samples.md).
class RglMask {
 public:
  // Of a file whose `rgb` has these slices, `rgb_slices` = phi_i x theta_i, rows and columns. A
  // file without the field `valid` measured all nodes. Throws Error where the field does not fit,
  // or does not tell which of its two values means measured.
  RglMask(const TensorFile& file, const std::vector<double>& theta_i, int rgb_slices, int rows,
          int columns);

  // theta_i of the last nodes that were measured, at most 90 degrees [rad].
  double max_theta() const { return max_theta_; }

  // Whether a blend of slices at a point reads, with weight, nothing but measured nodes.
  bool Measured(const SliceBlend& blend, const SquarePoint& point) const;

 private:
  int rows_, columns_;
  double max_theta_;
  std::vector<bool> measured_;  // [slices][rows][columns], or empty where all are
  // The same for the four nodes of a cell, at its first: most lookups need no more. Bytes, for
  // speed.
  std::vector<uint8_t> cell_measured_;
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_RGL_MASK_H_
