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

// Whether entries of D, F and G may be left out.
using ThinnedFactors = std::array<bool, 3>;

// The part of `stored` (or of all entries) that must be stored: without unobserved entries and,
// with `drop_equal`, without those inside runs of equal values. Keeps at least one entry per table.
// coverage: Objective::coverage().
TableLayout NeededLayout(const FactorModel& model, TableLayout stored,
                         std::span<const double> coverage, const ThinnedFactors& may_thin,
                         bool drop_equal);
TableLayout NeededLayout(const FactorModel& model, std::span<const double> coverage,
                         const ThinnedFactors& may_thin, bool drop_equal);

// Sharing by lobes and channels, regardless of the nodes of the tables.
struct ModelShape {
  std::string name;  // names the additional sharing; empty for a model's own shape
  ModelSpec spec;
  bool coloured_d = true, coloured_s = true;
  bool constant_G = false;
};

// The layout with the colour and G of the shape.
TableLayout LayoutOf(const ModelShape& shape, TableLayout layout);

// The model's own shape and all permitted shapes that share more, with the fewest parameters first.
std::vector<ModelShape> ShapesWithin(const ModelSpec& spec, const TableLayout& layout, bool colour,
                                     bool shadowing);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_STORED_LAYOUTS_H_
