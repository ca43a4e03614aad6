#ifndef TRILOBE_FIT_PRUNE_LOBE_SEARCH_H_
#define TRILOBE_FIT_PRUNE_LOBE_SEARCH_H_

#include <span>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Starting points with one lobe fewer: each lobe removed, each pair of lobes merged.
std::vector<FactorModel> WithOneLobeLess(const FactorModel& canonical);
// The layout of each of these for a model with this layout. A merged lobe has the nodes of both.
std::vector<TableLayout> LayoutsWithOneLobeLess(const ModelSpec& spec, const TableLayout& layout);

// Starting points with one more lobe: each lobe split. Empty if the model has no lobe, its lobes
// share D, or it has kMaxLobes.
std::vector<FactorModel> WithOneLobeMore(const FactorModel& canonical);

struct FittedModel {
  FactorModel model;
  double E = 0;
  int start = 0;  // index of its start
};

// E to reach, and the least relative gain of a step that lets a fit go on below it.
struct FitGoal {
  double E = 0;
  double least_gain = 1e-4;
};

// Fits models of the objective's spec from the starting points: all on thinned samples, in
// parallel, then the best on all samples. Ends when E falls by little or too slowly to reach its
// goal, or if stopped. With `layouts`, one per start, only stored parameters are fitted, which is
// faster.
FittedModel FitFrom(const std::vector<FactorModel>& starts, const Objective& objective,
                    const FitGoal& goal, const StopCheck& stop,
                    std::span<const TableLayout> layouts = {});

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_LOBE_SEARCH_H_
