#ifndef TRILOBE_FIT_PRIOR_NODE_RESIDUAL_H_
#define TRILOBE_FIT_PRIOR_NODE_RESIDUAL_H_

#include <optional>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// What a model lacks of the data at the nodes of a grid, where they stand: data less model, of
// either sign, linear between the nodes. Nothing where that does not help between them, as with
// highlights that are narrower than the grid's steps: unless what the 16 nodes around a node say of
// it, at double steps, leaves less of the lack's squares, as E weighs them, than saying 0 does.
// Throws Error for samples that stand elsewhere.
std::optional<NodeBrdf> LackOf(const FactorModel& model, const Objective& data,
                               const HemisphereGrid& grid);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRIOR_NODE_RESIDUAL_H_
