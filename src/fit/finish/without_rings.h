#ifndef TRILOBE_FIT_FINISH_WITHOUT_RINGS_H_
#define TRILOBE_FIT_FINISH_WITHOUT_RINGS_H_

#include <functional>
#include <optional>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// PSNR that a picture may lose for a model without rings, which are seen sooner [dB].
inline constexpr double kMayLoseForRings = 0.5;

// Whether uniform light shows rings on a sphere (RippleOf).
bool HasRings(const FactorModel& model, int num_threads);

// A model without rings, if this one has some: E knows values at the centers of bins alone, so it
// may ask for tables that alternate from entry to entry, or for bands. The smoothest one
// (Smoothest) that is `acceptable`, for the least of some shares by which E may rise. Nothing if
// there is none.
std::optional<FactorModel> WithoutRings(const Objective& objective, const FactorModel& model,
                                        const std::function<bool(const FactorModel&)>& acceptable,
                                        const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_WITHOUT_RINGS_H_
