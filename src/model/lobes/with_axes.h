#ifndef TRILOBE_MODEL_LOBES_WITH_AXES_H_
#define TRILOBE_MODEL_LOBES_WITH_AXES_H_

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// The model on the axes of another spec, with as many lobes and the same sharing: each entry of a
// new table is what the old one says there. So an isotropic model becomes an anisotropic one that
// is round, and a model on few nodes one on many. Throws Error where lobes or sharing differ.
FactorModel WithAxes(const FactorModel& model, const ModelSpec& spec);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOBES_WITH_AXES_H_
