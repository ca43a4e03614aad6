#ifndef TRILOBE_MODEL_APPEARANCE_NODE_RECONSTRUCTION_H_
#define TRILOBE_MODEL_APPEARANCE_NODE_RECONSTRUCTION_H_

#include <string>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/hemisphere_grid.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Any model at all pairs of nodes of a grid, clamped at 0, as a measurement would give it. `source`
// names it in messages. Throws Error if a value overflows.
Measurement ReconstructAtNodes(const FactorModel& model, const std::string& source,
                               const HemisphereGrid& grid);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_NODE_RECONSTRUCTION_H_
