#ifndef TRILOBE_FIT_FINISH_ANISOTROPIC_ALBEDO_H_
#define TRILOBE_FIT_FINISH_ANISOTROPIC_ALBEDO_H_

#include "fit/finish/albedo_limit.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// The largest directional albedo that an anisotropic fit may have (LimitByShown).
Rgb AnisotropicAlbedoLimit(const Objective& data, const FactorModel& model);

// LimitAlbedo for anisotropic models: lowers G where the directional albedo exceeds the limit, at
// each azimuth of its own. Looks at the rings of G and at 88 degrees, every 30 degrees of azimuth.
bool LimitAnisotropicAlbedo(const Rgb& limit, const TableLayout& layout, int num_threads,
                            const StopCheck& stop, FactorModel* model);

// The largest directional albedo there.
PeakAlbedo PeakAnisotropicAlbedo(const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_ANISOTROPIC_ALBEDO_H_
