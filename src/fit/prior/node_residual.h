#ifndef TRILOBE_FIT_PRIOR_NODE_RESIDUAL_H_
#define TRILOBE_FIT_PRIOR_NODE_RESIDUAL_H_

#include <optional>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Data less model at the nodes of a grid, where the data stand, and linear between them; of either
// sign. Nothing where that does not help between the nodes, as with highlights that are narrower
// than the grid's steps. It helps if the mean of the 16 nodes around a node, at double steps,
// leaves less of the squares of the residual there, as E weighs them, than 0 does. Throws Error for
// samples that stand elsewhere.
std::optional<NodeBrdf> InterpolateResidual(const FactorModel& model, const Objective& data,
                                            const HemisphereGrid& grid);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRIOR_NODE_RESIDUAL_H_
