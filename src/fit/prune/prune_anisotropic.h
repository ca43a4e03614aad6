#ifndef TRILOBE_FIT_PRUNE_PRUNE_ANISOTROPIC_H_
#define TRILOBE_FIT_PRUNE_PRUNE_ANISOTROPIC_H_

#include "fit/prune/prune_options.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Prune for an anisotropic model, whose tables are over two angles: isotropic where that keeps
// within the budget, and pruned further as any; else fewer lobes, fewer phi and theta of D and of
// G, F shared by the channels, G by the lobes, as long as it does. Each candidate is fitted to
// `with_prior`, the samples of `measured` and more between them (fit/prior/synthetic_prior.h), or
// `measured` itself, and judged on `measured`. `full` is a fit with their spec. Promises and errors
// are those of Prune, but that no lobes are added; with a budget of 0 nothing is left out.
PrunedModel PruneAnisotropic(const Objective& measured, const Objective& with_prior,
                             const FactorModel& full, const PruneOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_PRUNE_ANISOTROPIC_H_
