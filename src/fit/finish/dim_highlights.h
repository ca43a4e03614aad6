#ifndef TRILOBE_FIT_FINISH_DIM_HIGHLIGHTS_H_
#define TRILOBE_FIT_FINISH_DIM_HIGHLIGHTS_H_

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Between few incidences of a mirror-like scan nothing says how bright the highlight is, and a fit
// may reflect a hundred times the light. Refits an isotropic model of scattered samples until, up
// to their largest theta, its directional albedo is nowhere above its limit (LimitByShown): samples
// around each highlight that is too bright join those of `objective`, darker by what it exceeds,
// and count ten times as much each round. Up to four rounds. Returns whether anything changed.
bool DimHighlights(const StopCheck& stop, Objective* objective, FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_DIM_HIGHLIGHTS_H_
