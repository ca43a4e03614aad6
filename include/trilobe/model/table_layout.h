#ifndef TRILOBE_MODEL_TABLE_LAYOUT_H_
#define TRILOBE_MODEL_TABLE_LAYOUT_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// Interpolation of a table entry from two stored nodes, by index in the list of nodes:
// table[entry] = (1 - t) value[left] + t value[right].
struct NodeWeights {
  int left = 0, right = 0;
  double t = 0;
};

// Linear in the entry's index between nodes (for D, in sqrt(theta_h)), constant beyond the first
// and last node. A single node makes a constant table; a last node with value 0 makes a tail of
// zeros. `nodes` ascend. Throws Error if there are none.
NodeWeights WeightsAt(std::span<const int> nodes, int entry);

// The parameters of a model that are stored; the others are interpolated from them. Sharing between
// lobes or channels belongs to the spec.
struct TableLayout {
  bool coloured_d = true;  // false: d is the same in all channels, and stored once
  bool coloured_s = true;  // the same for the s of each lobe
  // The stored entries, ascending, by factor and table. [3][num_tables][1 to table_size]
  std::vector<std::vector<int>> nodes[3];

  // All parameters are stored.
  static TableLayout Full(const ModelSpec& spec);

  const std::vector<int>& of(Factor factor, int table) const {
    return nodes[static_cast<int>(factor)][table];
  }
  std::vector<int>& of(Factor factor, int table) { return nodes[static_cast<int>(factor)][table]; }

  // Number of stored parameters: values and stretch exponents, without node indices.
  int num_parameters(const ModelSpec& spec) const;
  // Number of stored node indices, of tables that are not stored completely.
  int num_places(const ModelSpec& spec) const;

  bool operator==(const TableLayout&) const = default;
};

// Throws Error unless the layout fits this spec.
void CheckLayout(const TableLayout& layout, const ModelSpec& spec);

// Computes the parameters that are not stored from the stored ones.
void ExpandStored(const TableLayout& layout, FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_TABLE_LAYOUT_H_
