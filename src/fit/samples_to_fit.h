#ifndef TRILOBE_FIT_SAMPLES_TO_FIT_H_
#define TRILOBE_FIT_SAMPLES_TO_FIT_H_

#include <functional>
#include <memory>

#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// FitOptions::select, or empty.
using SelectSamples = std::function<BrdfSamples(BrdfSamples)>;

// The samples that a fit is to.
BrdfSamples SamplesToFit(const Measurement& measurement, const SelectSamples& select);

// The same without a copy where they are those of the measurement, and for as long as that lives.
std::shared_ptr<const BrdfSamples> SharedSamplesToFit(const Measurement& measurement,
                                                      const SelectSamples& select);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SAMPLES_TO_FIT_H_
