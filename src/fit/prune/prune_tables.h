#ifndef TRILOBE_FIT_PRUNE_PRUNE_TABLES_H_
#define TRILOBE_FIT_PRUNE_PRUNE_TABLES_H_

#include "fit/prune/pruning.h"

namespace trilobe {

// Chooses the shape (what lobes and channels share) with the fewest predicted parameters after
// thinning, or with the lowest predicted E if the budget is in parameters.
void ChooseShape(Pruning* pruning);

// Eliminates nodes of the tables until the budget is spent.
void ThinTables(Pruning* pruning);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_PRUNE_TABLES_H_
