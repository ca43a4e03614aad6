#ifndef TRILOBE_FIT_PRUNE_PRUNE_H_
#define TRILOBE_FIT_PRUNE_PRUNE_H_

#include "fit/prune/prune_options.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Returns the smallest model found within the budget (docs/forms.md). `full` is a fit of the
// objective, with its spec. The result never exceeds the budget, up to rounding (1e-12 of E, or E
// of a fit that is exact but for rounding). If the full model does and more lobes do not help, the
// result is the closest model and the last decision says so. With a budget of 0 no parameter moves
// and only free reductions are made; without any, `full` is returned to the bit.
//
// Takes less time than a fit by the solver `auto`. The same bits for any number of threads. If a
// budget is relative to an E of practically 0, the first decision says so. Throws Error for a
// budget that is NaN or below one stored parameter.
PrunedModel Prune(const Objective& objective, const FactorModel& full, const PruneOptions& options);

// The same for a fit with a prior. Models are fitted to `with_prior`, the samples of `measured` and
// of the prior. The budget and all E of the result are of `measured` alone.
PrunedModel Prune(const Objective& measured, const Objective& with_prior, const FactorModel& full,
                  const PruneOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_PRUNE_H_
