#include "fit/prune/stored_layouts.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace trilobe {
namespace {

// The nodes between which an entry with data lies.
std::vector<int> ObservedNodes(const std::vector<int>& nodes, std::span<const double> coverage) {
  std::vector<bool> is_read(nodes.size());
  for (int k = 0; k < static_cast<int>(coverage.size()); ++k) {
    if (!(coverage[k] > 0)) continue;
    const NodeWeights at = WeightsAt(nodes, k);
    if (at.t < 1) is_read[at.left] = true;
    if (at.t > 0) is_read[at.right] = true;
  }
  std::vector<int> observed;
  for (size_t j = 0; j < nodes.size(); ++j) {
    if (is_read[j]) observed.push_back(nodes[j]);
  }
  if (observed.empty()) observed.push_back(nodes.front());
  return observed;
}

std::vector<int> NeededEntries(const std::vector<int>& nodes, std::span<const double> table,
                               std::span<const double> coverage, bool drop_equal) {
  std::vector<int> observed = ObservedNodes(nodes, coverage);
  if (!drop_equal) return observed;
  std::vector<int> needed;
  for (size_t i = 0; i < observed.size(); ++i) {
    const bool like_previous = i == 0 || table[observed[i]] == table[observed[i - 1]];
    const bool like_next = i + 1 == observed.size() || table[observed[i]] == table[observed[i + 1]];
    // At an end of the table the inner end of the run serves all of it.
    if (!like_previous || !like_next) needed.push_back(observed[i]);
  }
  if (needed.empty()) needed.push_back(observed.front());
  return needed;
}

}  // namespace

TableLayout NeededLayout(const FactorModel& model, TableLayout stored,
                         std::span<const double> coverage, const ThinnedFactors& may_thin,
                         bool drop_equal) {
  const ModelSpec& spec = model.spec();
  for (const Factor factor : kFactors) {
    if (!may_thin[static_cast<int>(factor)]) continue;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto table = model.table(factor, t);
      std::vector<int>& nodes = stored.of(factor, t);
      nodes = NeededEntries(
          nodes, table, coverage.subspan(model.TableOffset(factor, t), table.size()), drop_equal);
    }
  }
  return stored;
}

TableLayout NeededLayout(const FactorModel& model, std::span<const double> coverage,
                         const ThinnedFactors& may_thin, bool drop_equal) {
  return NeededLayout(model, TableLayout::Full(model.spec()), coverage, may_thin, drop_equal);
}

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
