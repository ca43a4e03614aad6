#ifndef TRILOBE_FIT_PRIOR_OF_H_
#define TRILOBE_FIT_PRIOR_OF_H_

#include <optional>

#include "trilobe/fit/finish/synthetic_prior.h"
#include "trilobe/fit/fit_options.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// SyntheticPriorOptions::weight of a fit; 0 for none, as for a table. Throws Error for a table that
// is to have one.
double PriorWeight(const Measurement& measurement, const FitOptions& options);

// The prior of a fit of scattered samples, for models of the spec of `data`. Nothing without one.
std::optional<SyntheticPrior> PriorOf(const Measurement& measurement, const FitOptions& options,
                                      const Objective& data);

Objective JoinPrior(const Objective& data, const std::optional<SyntheticPrior>& prior);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRIOR_OF_H_
