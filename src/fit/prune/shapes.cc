#include "fit/prune/shapes.h"

#include <algorithm>
#include <utility>

namespace trilobe {

TableLayout LayoutOf(const ModelShape& shape, TableLayout layout) {
  layout.coloured_d = shape.coloured_d;
  layout.coloured_s = shape.coloured_s;
  if (shape.constant_G) {
    for (std::vector<int>& nodes : layout.nodes[static_cast<int>(Factor::kG)]) nodes.resize(1);
  }
  return layout;
}

std::vector<ModelShape> ShapesWithin(const ModelSpec& spec, const TableLayout& layout, bool colour,
                                     bool shadowing) {
  const ModelShape own{
      .name = "", .spec = spec, .coloured_d = layout.coloured_d, .coloured_s = layout.coloured_s};
  std::vector<ModelShape> shapes = {own};
  const auto add = [&](ModelShape shape, const ModelShape& base, const std::string& name) {
    const bool changes = shape.spec != base.spec || shape.coloured_d != base.coloured_d ||
                         shape.coloured_s != base.coloured_s || shape.constant_G;
    shape.name = base.name + (base.name.empty() ? "" : ", ") + name;
    if (changes) shapes.push_back(std::move(shape));
  };
  if (colour) {
    ModelShape shape = own;
    if (spec.lobes > 0) {
      shape.spec.D.per_channel = shape.spec.F.per_channel = false;
      if (shadowing) shape.spec.G.per_channel = false;
      add(shape, own, "tables shared by the channels");
      shape.coloured_d = false;
      add(shape, own, "colour in s alone");
      shape.coloured_s = false;
    }
    shape.coloured_d = false;
    add(shape, own, "one channel for all");
  }
  if (shadowing && spec.lobes > 0) {
    for (const ModelShape& base : std::vector<ModelShape>(shapes)) {
      ModelShape shape = base;
      shape.spec.G.per_lobe = false;
      if (spec.lobes > 1) add(shape, base, "G shared by the lobes");
      shape.spec.G.per_channel = false;
      shape.constant_G = true;
      add(shape, base, "G constant");
    }
  }
  std::ranges::stable_sort(shapes, {}, [](const ModelShape& shape) {
    return LayoutOf(shape, TableLayout::Full(shape.spec)).num_parameters(shape.spec);
  });
  return shapes;
}

}  // namespace trilobe
