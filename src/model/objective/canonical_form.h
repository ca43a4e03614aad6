#ifndef TRILOBE_MODEL_OBJECTIVE_CANONICAL_FORM_H_
#define TRILOBE_MODEL_OBJECTIVE_CANONICAL_FORM_H_

#include "model/objective/gauge.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Brings a model of the objective's spec into canonical form (gauge.h), by the coverage of its
// samples and with its threads.
inline void Canonicalize(const Objective& objective, FactorModel* model,
                         LobeOrder order = LobeOrder::kByLight) {
  Canonicalize(objective.coverage(), model, order, objective.num_threads());
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_CANONICAL_FORM_H_
