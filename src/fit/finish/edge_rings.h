#ifndef TRILOBE_FIT_FINISH_EDGE_RINGS_H_
#define TRILOBE_FIT_FINISH_EDGE_RINGS_H_

#include <functional>
#include <optional>

#include "fit/finish/limit_light.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// A ring towards the rim of a sphere under even light.
struct EdgeRing {
  double share = 0, theta_i = 0;  // of the largest albedo there; [rad]
};

// The share below which a ring is not noticed.
inline constexpr double kSeenEdgeRing = 0.05;

// The highest ring of an isotropic model from 65 to 89.5 degrees: at each half degree, of any
// channel, the least difference between the albedo there and at the same distance to both sides, of
// up to 4 degrees, be it above or below both. A rise or a fall towards the horizon is none. Zero
// for an anisotropic model. The same bits for any number of threads.
EdgeRing EdgeRingOf(const FactorModel& model, int num_threads);

// A model without rings at the end of the data, if they end before the horizon and this model has
// some. The last degrees of a measurement are its worst: few samples of little weight read them,
// and huge values of F make up for tiny ones of G. The step from there to what is beyond is seen as
// a bright or dark ring. So F and G go on together from where F ends, from 1 or 2 degrees before,
// or as they are (ContinueTogether), and then follow ever smoother courses (FollowCourse): the
// first with which no ring is noticed, or the one with the lowest, of those that are `acceptable`.
// All keep to `limit`, if there is one. Values of stored nodes change, and the others follow.
// Nothing if there is none.
std::optional<FactorModel> WithoutEdgeRings(
    const Objective& data, const FactorModel& model, const TableLayout& layout,
    const LightLimit* limit, const std::function<bool(const FactorModel&)>& acceptable,
    const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_EDGE_RINGS_H_
