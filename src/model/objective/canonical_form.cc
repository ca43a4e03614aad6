#include "model/objective/canonical_form.h"

namespace trilobe {

void Canonicalize(const Objective& objective, FactorModel* model, LobeOrder order) {
  Canonicalize(objective.coverage(), model, order, objective.num_threads());
}

}  // namespace trilobe
