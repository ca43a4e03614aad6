#ifndef TRILOBE_FIT_FINISH_DATA_EDGE_H_
#define TRILOBE_FIT_FINISH_DATA_EDGE_H_

#include <span>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// When the refit of what is left ends: once E settles, or after the first step that brings it back,
// for a model that will be refitted anyway.
enum class TieRefit { kUntilSettled, kUntilBack };

// Towards grazing angles, and most of all where a measurement ends before 90 degrees, the last
// entries of D, F and G are read by few samples of little weight, which leave them free to trade
// huge values against tiny ones of each other. At the bins these fit; between them, and beyond the
// data, their products grow without bound: white rings around a sphere. This ties such entries to
// the last one before them, and refits all parameters by a few joint steps. Tied are, at the end of
// a table,
// - before unobserved entries, those with less than a twentieth of the coverage of the third one
//   inwards;
// - those from the first on, in the last third, that is five times the median of the five before
// it. True, with the new model, if E came back to within 5 % of what it was (0.01 to 3 % are seen,
// in samples at the very edge); false, and the model as it was, if not, or if there is nothing to
// tie. `stop` is asked before each step of the refit: once it says so there are no more, and the
// model is judged as it is. Throws Error for a model of another spec, or with parameters that none
// has.
bool TieEntriesAtDataEdge(const Objective& objective, FactorModel* model,
                          const StopCheck& stop = {}, TieRefit refit = TieRefit::kUntilSettled);

// The entries of a model with this coverage (Objective::coverage) that are not tied: all but those
// that, at the end of what is observed of a table, equal the one before them, as those of a tail of
// zeros do, and unobserved ones behind such. What moves these and expands them keeps the others
// tied.
TableLayout UntiedEntries(std::span<const double> coverage, const FactorModel& model);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_DATA_EDGE_H_
