#ifndef TRILOBE_FIT_AZIMUTHS_H_
#define TRILOBE_FIT_AZIMUTHS_H_

#include <functional>
#include <optional>

#include "trilobe/fit/azimuth_choice.h"
#include "trilobe/fit/fit_options.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Whether a fit by these options chooses between an isotropic and an anisotropic model: of samples
// whose azimuths are given, unless the options or the measurement say what to take.
bool ChoosesAzimuths(const Measurement& measurement, const FitOptions& options);

// The model of a fit; nothing if that was stopped.
using FitModel = std::function<std::optional<FactorModel>(const Measurement&, const FitOptions&)>;

// Whether the material depends on the azimuth of the light, for a measurement that is taken for
// anisotropic since azimuths are given. In this order:
// - samples that are there at several turns of the material say so (AnisotropyOf), if at least half
//   of them are;
// - far fewer values than an anisotropic model has parameters cannot say so;
// - otherwise, held-out blocks decide, by E of default fits to the others; `fit` makes these.
AzimuthChoice ChooseAzimuths(const Measurement& measurement, const FitOptions& options,
                             const FitModel& fit);

// The measurement as of an isotropic material.
Measurement WithoutAzimuths(const Measurement& measurement);

}  // namespace trilobe

#endif  // TRILOBE_FIT_AZIMUTHS_H_
