#ifndef TRILOBE_FIT_PRUNE_NODE_ELIMINATION_H_
#define TRILOBE_FIT_PRUNE_NODE_ELIMINATION_H_

#include <vector>

#include "fit/prune/needed_layout.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// A node that is given up: its entry becomes linear between those that are left (WeightsAt).
struct Elimination {
  Factor factor = Factor::kD;
  int table = 0, entry = 0;
  double rise = 0;  // of E by this one and all before it, predicted, all other parameters refitted
};

struct EliminationLimits {
  double max_rise = 0;  // of E, predicted
  int max_count = 0;
  ThinnedFactors may_thin = {true, true, true};
};

// In which order to give up nodes of a model that was fitted in the parameters of its layout: the
// next one is always that which makes E rise least. `at` is the problem in all the model's
// parameters.
//
// E is taken for the quadratic of `at`, at whose minimum the model is taken to be. A node that
// becomes a combination of its neighbours is a linear constraint c'y = 0; with the covariance
// P = H^-1 of the parameters y it raises the minimum by (c'y)^2 / c'P c, and the minimum and P
// follow by updates of rank one. Parameters at the bound 0 are held there, by pivots on the same
// matrix (docs/pruning.md).
std::vector<Elimination> OrderOfElimination(const QuadraticModel& at, const FactorModel& model,
                                            const TableLayout& layout,
                                            const EliminationLimits& limits);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_NODE_ELIMINATION_H_
