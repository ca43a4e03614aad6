#ifndef TRILOBE_FIT_FINISH_RETRO_RIM_H_
#define TRILOBE_FIT_FINISH_RETRO_RIM_H_

#include <functional>
#include <optional>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// The bright rim of a sphere whose light comes from the eye, that a measurement says nothing of:
//   r(theta) = f(w, w) cos theta
// of an isotropic model, where it is largest over its limit: 1.5 times what samples with theta_d up
// to 12 degrees reflect so at most, from 50 degrees to the end of the data, or the model itself
// there without such samples. It is seen where it is above twice the limit and would be a
// hundredth of white.
struct RetroRim {
  double over_limit = 0, theta = 0;  // r over its limit, where it is bright enough; [rad]
  bool is_seen() const { return over_limit > 2; }
};
RetroRim RetroRimOf(const Objective& data, const FactorModel& model);

// A model without such a rim, if this model has one: G^2 / cos theta grows where F falls along a
// highlight, and D of half vectors beyond the data does not know. So D falls there, of stored
// nodes. Nothing if there is no rim, or if that is not `acceptable`.
std::optional<FactorModel> WithoutRetroRim(
    const Objective& data, const FactorModel& model, const TableLayout& layout,
    const std::function<bool(const FactorModel&)>& acceptable, const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_RETRO_RIM_H_
