#ifndef TRILOBE_MODEL_MEASUREMENT_HEMISPHERE_GRID_H_
#define TRILOBE_MODEL_MEASUREMENT_HEMISPHERE_GRID_H_

#include <string_view>

#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/node_brdf.h"

namespace trilobe {

// "18x72": 18 theta and 72 phi. Throws Error for anything else, and for grids of more than ten
// million pairs of directions.
HemisphereGrid ParseHemisphereGrid(std::string_view text);

// A measurement of anything at all pairs of nodes of a grid. Where a table or a function was not
// measured, or has no value, the sample is missing. Scattered samples must stand at nodes, one at
// each pair at most; throws Error where they do not. Azimuths matter, whatever the material.
Measurement AtNodes(const Measurement& measurement, const HemisphereGrid& grid, int num_threads);

// The values of scattered samples at their nodes. Throws Error as above.
NodeTable ValuesAtNodes(const Measurement& scattered, const HemisphereGrid& grid);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_HEMISPHERE_GRID_H_
