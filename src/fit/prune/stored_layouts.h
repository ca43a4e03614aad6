#ifndef TRILOBE_FIT_PRUNE_STORED_LAYOUTS_H_
#define TRILOBE_FIT_PRUNE_STORED_LAYOUTS_H_

#include <array>
#include <span>
#include <string>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Of which factors entries may be left out: D, F, G.
using ThinnedFactors = std::array<bool, 3>;

// What must be stored of a model, of what `stored` has or of all: not the entries that no data
// touch and, with `drop_equal`, not those within a run of equal values. Of each table one entry is
// kept at least. coverage: of each number of the model (Objective::coverage).
TableLayout NeededLayout(const FactorModel& model, TableLayout stored,
                         std::span<const double> coverage, const ThinnedFactors& may_thin,
                         bool drop_equal);
TableLayout NeededLayout(const FactorModel& model, std::span<const double> coverage,
                         const ThinnedFactors& may_thin, bool drop_equal);

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

#endif  // TRILOBE_FIT_PRUNE_STORED_LAYOUTS_H_
