#ifndef TRILOBE_FIT_PRUNE_SHAPES_H_
#define TRILOBE_FIT_PRUNE_SHAPES_H_

#include <string>
#include <vector>

#include "trilobe/model/model_spec.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// What lobes and channels share, whatever nodes the tables have.
struct ModelShape {
  std::string name;  // what is shared that was not; empty for a model's own shape
  ModelSpec spec;
  bool coloured_d = true, coloured_s = true;
  bool constant_G = false;
};

// The layout with the shape's colour, and its G.
TableLayout LayoutOf(const ModelShape& shape, TableLayout layout);

// The model's own shape, and those that share more of what may be shared; the one with the fewest
// parameters first.
std::vector<ModelShape> ShapesWithin(const ModelSpec& spec, const TableLayout& layout, bool colour,
                                     bool shadowing);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_SHAPES_H_
