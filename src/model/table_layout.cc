#include "trilobe/model/table_layout.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <string>

#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

NodeWeights WeightsAt(std::span<const int> nodes, int entry) {
  if (nodes.empty()) {
    throw Error(ErrorKind::kMissing, "a table needs one node or more").About("nodes");
  }
  const auto right = std::ranges::lower_bound(nodes, entry);
  const int r = static_cast<int>(right - nodes.begin());
  if (right == nodes.end()) return {r - 1, r - 1, 0};
  if (r == 0 || *right == entry) return {r, r, 0};
  return {r - 1, r, static_cast<double>(entry - nodes[r - 1]) / (nodes[r] - nodes[r - 1])};
}

TableLayout TableLayout::Full(const ModelSpec& spec) {
  TableLayout layout;
  for (const Factor factor : kFactors) {
    std::vector<int> all(spec.table_size(factor));
    std::iota(all.begin(), all.end(), 0);
    layout.nodes[static_cast<int>(factor)].assign(spec.num_tables(factor), all);
  }
  return layout;
}

int TableLayout::num_parameters(const ModelSpec& spec) const {
  int parameters = (coloured_d ? kChannels : 1) + spec.lobes * (coloured_s ? kChannels : 1);
  if (spec.stretches.any() && spec.lobes > 0) {
    parameters += 2 * (spec.stretches.several() ? spec.lobes : 1);
  }
  for (const auto& tables : nodes) {
    for (const std::vector<int>& table : tables) parameters += static_cast<int>(table.size());
  }
  return parameters;
}

int TableLayout::num_places(const ModelSpec& spec) const {
  int places = 0;
  for (const Factor factor : kFactors) {
    for (const std::vector<int>& table : nodes[static_cast<int>(factor)]) {
      const int size = static_cast<int>(table.size());
      if (size < spec.table_size(factor)) places += size;
    }
  }
  return places;
}

void CheckLayout(const TableLayout& layout, const ModelSpec& spec) {
  for (const Factor factor : kFactors) {
    const auto& tables = layout.nodes[static_cast<int>(factor)];
    const std::string name = FactorName(factor);
    if (static_cast<int>(tables.size()) != spec.num_tables(factor)) {
      throw Error(ErrorKind::kMismatch, "the layout has " + std::to_string(tables.size()) +
                                            " tables " + name + ", but the model " +
                                            std::to_string(spec.num_tables(factor)))
          .About(name, tables.size());
    }
    for (const std::vector<int>& nodes : tables) {
      const bool ascend = std::ranges::adjacent_find(nodes, std::greater_equal()) == nodes.end();
      if (nodes.empty() || !ascend || nodes.front() < 0 ||
          nodes.back() >= spec.table_size(factor)) {
        throw Error(ErrorKind::kRange, "the nodes of a table " + name +
                                           " must be one or more, ascending, from 0 to " +
                                           std::to_string(spec.table_size(factor) - 1))
            .About(name);
      }
    }
  }
}

void ExpandStored(const TableLayout& layout, FactorModel* model) {
  const ModelSpec& spec = NotNull(model, "the model").spec();
  CheckLayout(layout, spec);
  const auto share = [](bool coloured, std::span<double> values) {
    if (!coloured) std::ranges::fill(values, values[0]);
  };
  share(layout.coloured_d, model->d());
  for (int m = 0; m < spec.lobes; ++m) share(layout.coloured_s, model->s(m));
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const std::vector<int>& nodes = layout.of(factor, t);
      const std::span<double> table = model->table(factor, t);
      for (int entry = 0; entry < static_cast<int>(table.size()); ++entry) {
        const NodeWeights at = WeightsAt(nodes, entry);
        const double left = table[nodes[at.left]], right = table[nodes[at.right]];
        if (nodes[at.right] != entry) table[entry] = (1 - at.t) * left + at.t * right;
      }
    }
  }
}

}  // namespace trilobe
