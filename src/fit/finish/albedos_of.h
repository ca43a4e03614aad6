#ifndef TRILOBE_FIT_FINISH_ALBEDOS_OF_H_
#define TRILOBE_FIT_FINISH_ALBEDOS_OF_H_

#include <span>
#include <vector>

#include "model/measurement/albedo_rule.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {

// The directional albedo of an isotropic model at theta_i [rad], by the rule of DirectionalAlbedo:
// it reflects as much to one side of the plane of incidence as to the other. With fewer azimuths,
// an even number, it is a quick look.
Rgb AlbedoOf(const PreparedModel<double>& prepared, double theta_i, int azimuths = kAlbedoAzimuths);

// The same for many angles. [theta_i.size()]
std::vector<Rgb> AlbedosOf(const FactorModel& model, std::span<const double> theta_i,
                           int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_ALBEDOS_OF_H_
