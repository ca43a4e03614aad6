#ifndef TRILOBE_MODEL_LOBES_CANONICAL_SCALE_H_
#define TRILOBE_MODEL_LOBES_CANONICAL_SCALE_H_

#include <span>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/lobes/lobe_light.h"

namespace trilobe {

// Brings the largest observed entry of each table into [1/2, 1) by a power of two, which rounds
// nothing, so that products of entries neither overflow nor vanish. Tables without a value become
// constant (MoveZeroToS).
void ScaleIntoRange(std::span<const double> coverage, FactorModel* model);

// The canonical scale (gauge.h) of a model in that range: `light` is what it reflects.
void ScaleByLight(std::span<const double> coverage, const LobeLight& light, FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOBES_CANONICAL_SCALE_H_
