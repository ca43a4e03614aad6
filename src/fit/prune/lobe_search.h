#ifndef TRILOBE_FIT_PRUNE_LOBE_SEARCH_H_
#define TRILOBE_FIT_PRUNE_LOBE_SEARCH_H_

#include <span>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Starting points with one lobe less: each lobe left out, each pair of lobes merged.
std::vector<FactorModel> WithOneLobeLess(const FactorModel& canonical);
// What is stored of each of these, where so much is stored of the model: a lobe of two merged ones
// has the nodes of both.
std::vector<TableLayout> LayoutsWithOneLobeLess(const ModelSpec& spec, const TableLayout& layout);

// Starting points with one lobe more: each lobe split. None if the model has no lobe, its lobes
// share D, or there are kMaxLobes.
std::vector<FactorModel> WithOneLobeMore(const FactorModel& canonical);

struct FittedModel {
  FactorModel model;
  double E = 0;
  int start = 0;  // by its number
};

// Where E is to come down to, and what a step has to gain of it from there on for more to follow.
struct FitGoal {
  double E = 0;
  double least_gain = 1e-4;
};

// Fits a model with the objective's spec from the starting points: first on thinned samples, side
// by side, then the best on all. Ends when E falls by little, or so slowly that it will not come
// down to its goal, or when `stop` says so. With `layouts`, one for each start, only what is stored
// is fitted, which is less work.
FittedModel FitFrom(const std::vector<FactorModel>& starts, const Objective& objective,
                    const FitGoal& goal, const StopCheck& stop,
                    std::span<const TableLayout> layouts = {});

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_LOBE_SEARCH_H_
