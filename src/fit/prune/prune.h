#ifndef TRILOBE_FIT_PRUNE_PRUNE_H_
#define TRILOBE_FIT_PRUNE_PRUNE_H_

#include "fit/prune/prune_options.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// The smallest model found that keeps within the budget (docs/pruning.md). `full` is a fit of the
// objective and has its spec. What is returned never exceeds the budget, up to rounding (1e-12 of
// E, and E of a fit that is exact but for rounding); if the full model does, and more lobes do not
// help, it is the one that comes closest, and the last decision says so. With a budget of 0 nothing
// moves, and only what is free is left out; where that is nothing, `full` comes back to the bit.
//
// Costs less than a fit by the solver `auto`; the same bits for any number of threads.
// Where a budget is relative to an E that is practically 0, so that it allows next to nothing, the
// first decision says so. Throws Error for a budget that is no number, or less than one stored
// parameter.
PrunedModel Prune(const Objective& objective, const FactorModel& full, const PruneOptions& options);

// The same for a fit that had a prior: models are fitted to `with_prior`, the samples of `measured`
// and those of the prior, and held against the budget by `measured` alone, as are all E of the
// result.
PrunedModel Prune(const Objective& measured, const Objective& with_prior, const FactorModel& full,
                  const PruneOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_PRUNE_H_
