#ifndef TRILOBE_FIT_CHOOSE_AZIMUTHS_H_
#define TRILOBE_FIT_CHOOSE_AZIMUTHS_H_

#include "trilobe/fit/fit_options.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// The measurement, marked as isotropic or as one whose azimuths matter, as Fit by these options
// takes it, with a note that says why. Others are returned as they are. For judges and problems
// beside a fit.
Measurement WithAzimuthsChosen(Measurement measurement, const FitOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_CHOOSE_AZIMUTHS_H_
