#ifndef TRILOBE_FIT_FINISH_DATA_EDGE_H_
#define TRILOBE_FIT_FINISH_DATA_EDGE_H_

#include <span>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// When the refit ends: when E settles, or at the first step within the limit on E, for a model that
// will be refitted anyway.
enum class TieRefit { kUntilSettled, kUntilBack };

// Ties the last entries of tables that the data hardly determine, and refits the others.
//
// At grazing angles, above all if a measurement ends before 90 degrees, few samples of little
// weight read the last entries of D, F and G. Huge values of one factor can then compensate tiny
// values of another. They fit at the bins, but between and beyond them their products grow without
// bound: white rings around a sphere. At the end of a table, these are tied to the entry before:
// - before unobserved entries, those with less than a twentieth of the coverage of the third entry
//   inwards;
// - in the last third, all from the first that exceeds five times the median of the five before it.
// All parameters are refitted by a few joint steps. Returns true, with the new model, if E returns
// to within 5 % of its old value (typically 0.01 to 3 %). Else, or with nothing to tie, returns
// false and keeps the model. `stop` ends the refit. Throws Error for a model of another spec or
// with invalid parameters.
bool TieEntriesAtDataEdge(const Objective& objective, FactorModel* model,
                          const StopCheck& stop = {}, TieRefit refit = TieRefit::kUntilSettled);

// The layout of the entries that are not tied. Tied are entries at the end of the observed part of
// a table that equal the one before them (also in a tail of zeros), and the unobserved ones behind
// them. Fits in this layout keep them tied. coverage: Objective::coverage().
TableLayout UntiedEntries(std::span<const double> coverage, const FactorModel& model);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_DATA_EDGE_H_
