#ifndef TRILOBE_MODEL_READ_FIT_INFO_H_
#define TRILOBE_MODEL_READ_FIT_INFO_H_

#include "model/json_node.h"
#include "trilobe/model/fit_info.h"

namespace trilobe {

// Member "fit" of a model file of any kind. Fields missing in the file stay unknown.
FitInfo ReadFitInfo(const JsonNode& root);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_READ_FIT_INFO_H_
