#ifndef TRILOBE_FIT_PRUNE_PRUNE_TABLES_H_
#define TRILOBE_FIT_PRUNE_PRUNE_TABLES_H_

#include "fit/prune/pruning.h"

namespace trilobe {

// Goes on with the shape (what lobes and channels share) that promises the fewest parameters, or
// the lowest E where the budget is one of parameters, once nodes are given up too.
void ChooseShape(Pruning* pruning);

// Gives up nodes of the tables until the budget is spent.
void ThinTables(Pruning* pruning);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_PRUNE_TABLES_H_
