#ifndef TRILOBE_FIT_HELD_OUT_FIT_H_
#define TRILOBE_FIT_HELD_OUT_FIT_H_

#include <functional>
#include <optional>

#include "trilobe/fit/fit_options.h"
#include "trilobe/fit/held_out_error.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// FitResult::held_out of a fit by these options, with options.held_out: repeats the fit without the
// held-out blocks (HeldOutPart), for the same spec, and compares it with them. Nothing if the
// samples are too few for that, or if there is no such fit. Throws Error as Fit does.
// `fit`: the model of a fit by other options; nothing if it is stopped, or could not choose a form.
std::optional<HeldOutError> FitWithoutHeldOut(
    const Measurement& measurement, const FitOptions& options, const ModelSpec& spec,
    const std::function<std::optional<FactorModel>(const FitOptions&)>& fit);

}  // namespace trilobe

#endif  // TRILOBE_FIT_HELD_OUT_FIT_H_
