#ifndef TRILOBE_FIT_FINISH_ALBEDOS_OF_H_
#define TRILOBE_FIT_FINISH_ALBEDOS_OF_H_

#include <span>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The directional albedos of an isotropic model at theta_i [rad] (DirectionalAlbedos).
// [theta_i.size()]
std::vector<Rgb> AlbedosOf(const FactorModel& model, std::span<const double> theta_i,
                           int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_ALBEDOS_OF_H_
