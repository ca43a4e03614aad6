#ifndef TRILOBE_FIT_AS_MEASUREMENT_H_
#define TRILOBE_FIT_AS_MEASUREMENT_H_

#include <string>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/node_brdf.h"

namespace trilobe {

// Evaluates a model as a measurement: an isotropic one at all bins of MERL's grid with both
// directions above the surface, an anisotropic one at all pairs of nodes of `grid`. `source` names
// it in messages.
Measurement AsMeasurement(const FactorModel& model, const std::string& source, int num_threads,
                          const HemisphereGrid& grid);

}  // namespace trilobe

#endif  // TRILOBE_FIT_AS_MEASUREMENT_H_
