#ifndef TRILOBE_MODEL_OBJECTIVE_ROBUST_H_
#define TRILOBE_MODEL_OBJECTIVE_ROBUST_H_

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// The objective's samples for the next pass of a fit by a loss that grows linearly with the error
// beyond `delta`, by iteratively reweighted least squares: a sample whose error e is larger counts
// delta / e times as often (Huber 1964). e is the root mean square over the channels of the error
// as the weighting sees it, which is a relative error under weights relative to the value, in units
// of the level where the weighting has one. E of the samples that come back, up to a constant, lies
// above that loss and touches it at `model` (Hunter and Lange 2004), so that what lowers E lowers
// the loss. Throws Error unless delta > 0.
BrdfSamples Reweighted(const Objective& objective, const FactorModel& model, double delta);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_ROBUST_H_
