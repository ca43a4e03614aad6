#ifndef TRILOBE_MODEL_EVALUATE_NODES_OF_Y_H_
#define TRILOBE_MODEL_EVALUATE_NODES_OF_Y_H_

#include <vector>

#include "trilobe/model/model_spec.h"

namespace trilobe {

// sin^2 theta_h of the entries of D and some between them, from 0 to 1; where D is linear between
// its entries, so is a table in sin^2 theta_h between these, or nearly.
std::vector<double> NodesOfY(const ModelSpec& spec);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_EVALUATE_NODES_OF_Y_H_
