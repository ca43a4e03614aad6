#ifndef TRILOBE_FIT_PRUNE_NEEDED_LAYOUT_H_
#define TRILOBE_FIT_PRUNE_NEEDED_LAYOUT_H_

#include <array>
#include <span>

#include "trilobe/model/factor_model.h"
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

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_NEEDED_LAYOUT_H_
