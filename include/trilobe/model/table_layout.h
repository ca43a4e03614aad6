#ifndef TRILOBE_MODEL_TABLE_LAYOUT_H_
#define TRILOBE_MODEL_TABLE_LAYOUT_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// One entry of a table between the entries that are stored, by their numbers in the list of nodes:
// table[entry] = (1 - t) value[left] + t value[right].
struct NodeWeights {
  int left = 0, right = 0;
  double t = 0;
};

// Linear between nodes, in the number of the entry (for D that is the coordinate sqrt(theta_h));
// constant beyond the first and the last. So one node is a constant table, and a last node that is
// 0 makes a tail of zeros. `nodes` ascend; Error if there is none.
NodeWeights WeightsAt(std::span<const int> nodes, int entry);

// Which of a model's parameters are stored, if not all: the others follow from those. What is
// shared by lobes or channels is no matter of the layout but of the spec.
struct TableLayout {
  bool coloured_d = true;  // false: d is the same in all channels, and stored once
  bool coloured_s = true;  // the same for the s of each lobe
  // The stored entries of each table, ascending, by factor and number of the table.
  // [3][num_tables][1 to table_size]
  std::vector<std::vector<int>> nodes[3];

  // Everything is stored.
  static TableLayout Full(const ModelSpec& spec);

  const std::vector<int>& of(Factor factor, int table) const {
    return nodes[static_cast<int>(factor)][table];
  }
  std::vector<int>& of(Factor factor, int table) { return nodes[static_cast<int>(factor)][table]; }

  // How many parameters are stored: values, those of a stretch too, without the places of nodes.
  int num_parameters(const ModelSpec& spec) const;
  // How many places of nodes are stored with them: those of tables that are not stored as a whole.
  int num_places(const ModelSpec& spec) const;

  bool operator==(const TableLayout&) const = default;
};

// Throws Error unless the layout is one of a model with this spec.
void CheckLayout(const TableLayout& layout, const ModelSpec& spec);

// Sets the parameters that are not stored from those that are.
void ExpandStored(const TableLayout& layout, FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_TABLE_LAYOUT_H_
