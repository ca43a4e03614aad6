#ifndef TRILOBE_FIT_FINISH_ALBEDO_LIMIT_H_
#define TRILOBE_FIT_FINISH_ALBEDO_LIMIT_H_

#include <vector>

#include "fit/finish/light_bounds.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// The largest directional albedo that a model may have, by channel.
struct AlbedoLimits {
  std::vector<double> theta_i;  // where it is computed, ascending [rad]
  Rgb everywhere = {1, 1, 1};
  std::vector<Rgb> beyond;  // of G beyond the data, at most `everywhere`. [theta_i.size()]
  double beyond_theta = 0;  // where the data end [rad]
};

// Limits for an isotropic fit: 1, or what the samples themselves reflect where that is more, as of
// a measurement in other units (of scattered samples LimitByShown, with `model`). Beyond the last
// well-covered entry of G, the albedo goes on as it does within the data (LevelledOff), and the
// limit is half above that.
AlbedoLimits AlbedoLimitsOf(const Objective& data, const FactorModel& model);

// The limit at an angle: of G beyond the data, linear between its angles. [rad]
Rgb LimitAt(const AlbedoLimits& limits, double theta);

// Lowers G of all lobes where the directional albedo exceeds the limit, until it does so nowhere:
// by the root of the excess, since both G(theta_i) and G(theta_o) make a highlight. Then holds it
// to `everywhere` at all nodes of G, too, and halfway between those beyond 60 degrees. Beyond the
// data, and at angles above `from` [rad]: kAllAngles, or those where G is free. Stored nodes
// change, and the others follow (ExpandStored). Returns whether anything changed. The same bits for
// any number of threads.
constexpr double kAllAngles = -1;
bool LimitAlbedo(const AlbedoLimits& limits, double from, const TableLayout& layout,
                 int num_threads, const StopCheck& stop, FactorModel* model);

// That of an isotropic model.
PeakAlbedo PeakAlbedoOf(const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_ALBEDO_LIMIT_H_
