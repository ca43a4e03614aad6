#ifndef TRILOBE_SOLVERS_RACE_STRETCH_SEARCH_H_
#define TRILOBE_SOLVERS_RACE_STRETCH_SEARCH_H_

#include <functional>

#include "trilobe/model/factor_model.h"
#include "trilobe/objective/objective.h"

namespace trilobe {

// The same parameters under another stretch of the highlights.
FactorModel WithStretch(const FactorModel& model, const Stretch& stretch);

// The stretch with which E is lowest, to 0.05 in both exponents, and a model with it that is fitted
// to a thinned selection of the samples: a compass search (Kolda, Lewis, Torczon 2003), in which
// every point goes on from the model of the best one before it by some joint steps. `fitted` is a
// fit of the objective, isotropic and without a stretch. Once `stop` is true the best so far is
// returned. The same bits for any number of threads, as long as it stays false.
FactorModel FitStretch(const Objective& objective, const FactorModel& fitted,
                       const std::function<bool()>& stop);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_RACE_STRETCH_SEARCH_H_
