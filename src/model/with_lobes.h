#ifndef TRILOBE_MODEL_WITH_LOBES_H_
#define TRILOBE_MODEL_WITH_LOBES_H_

#include <span>

#include "trilobe/model/factor_model.h"

namespace trilobe {

// Throws Error if the model has no such lobe.
void CheckLobe(const FactorModel& model, int lobe);

// The model whose k-th lobe is a copy of lobes[k], with d as it is. A lobe may come several times.
// Throws Error if there is no such lobe, or if there are more than kMaxLobes.
FactorModel WithLobes(const FactorModel& model, std::span<const int> lobes);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_WITH_LOBES_H_
