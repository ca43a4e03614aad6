#ifndef TRILOBE_FIT_PRUNE_PRUNE_ANISOTROPIC_H_
#define TRILOBE_FIT_PRUNE_PRUNE_ANISOTROPIC_H_

#include "fit/prune/prune_options.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Prune for an anisotropic model. If an isotropic model is within the budget, prunes that. Else
// tries, within the budget, fewer lobes, fewer phi and theta of D and G, F shared by the channels,
// and G shared by the lobes. Candidates are fitted to `with_prior` (`measured` and samples of a
// SyntheticPrior, or `measured` itself) and judged on `measured`. `full` is a fit with their spec.
// Guarantees and errors are those of Prune, except that no lobes are added and with a budget of 0
// nothing is left out.
PrunedModel PruneAnisotropic(const Objective& measured, const Objective& with_prior,
                             const FactorModel& full, const PruneOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_PRUNE_ANISOTROPIC_H_
