#ifndef TRILOBE_FIT_FINISH_NODE_RESIDUAL_H_
#define TRILOBE_FIT_FINISH_NODE_RESIDUAL_H_

#include <optional>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// The residual data - model at the nodes of a grid, linear between them. Returns nothing if it does
// not help between the nodes, as for highlights narrower than the steps of the grid. It helps if
// the mean of the 16 nodes around a node, at double steps, predicts the residual there better than
// 0 does, in squares weighted as in E. Throws Error for samples that are not at nodes.
std::optional<NodeBrdf> InterpolateResidual(const FactorModel& model, const Objective& data,
                                            const HemisphereGrid& grid);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_NODE_RESIDUAL_H_
