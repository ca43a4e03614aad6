#ifndef TRILOBE_IO_FORMATS_OPTICAL_TENSOR_TREE_H_
#define TRILOBE_IO_FORMATS_OPTICAL_TENSOR_TREE_H_

#include <functional>
#include <string>
#include <string_view>

#include "trilobe/core/base/directions.h"

namespace trilobe {

// Throws: says what is wrong, and in a word what is there, or should be.
using TreeFailure = std::function<void(const std::string& problem, std::string_view value)>;

// Reads a tensor tree of Radiance (Ward, Kurt and Bonneel 2012), of rank 3 (isotropic) or 4: nested
// braces that halve each axis of the unit cube, the leaves of which hold a value or a grid of them.
// Calls `add` with the directions of the centre of each cell, by Shirley and Chiu's map of the
// square to the disk, and its value. `fail` is called for anything else.
void ReadTensorTree(std::string_view text, int rank, const TreeFailure& fail,
                    const std::function<void(const SphericalAngles&, double)>& add);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_OPTICAL_TENSOR_TREE_H_
