#ifndef TRILOBE_PRUNE_LOBE_SEARCH_H_
#define TRILOBE_PRUNE_LOBE_SEARCH_H_

#include <vector>

#include "trilobe/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/objective/objective.h"

namespace trilobe {

// Starting points with one lobe less: each lobe left out, each pair of lobes merged.
std::vector<FactorModel> WithOneLobeLess(const FactorModel& canonical);

// Starting points with one lobe more: each lobe split. None if the model has no lobe, its lobes
// share D, or there are kMaxLobes.
std::vector<FactorModel> WithOneLobeMore(const FactorModel& canonical);

struct FittedModel {
  FactorModel model;
  double E = 0;
};

// Fits a model with the objective's spec from the starting points: first on thinned samples, side
// by side, then the best on all. Ends when E falls by little, or so slowly that it will not come
// down to `wanted`, or when `stop` says so.
FittedModel FitFrom(const std::vector<FactorModel>& starts, const Objective& objective,
                    double wanted, const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_PRUNE_LOBE_SEARCH_H_
