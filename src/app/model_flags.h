#ifndef TRILOBE_APP_MODEL_FLAGS_H_
#define TRILOBE_APP_MODEL_FLAGS_H_

#include <string>
#include <vector>

#include "trilobe/io/measurement.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/solvers/node_choice.h"

namespace trilobe {

// The model that --model, --lobes, --d_nodes, --f_bins and --g_nodes ask for, for this measurement:
// the paper's isotropic one by default, or where azimuths were measured and matter an anisotropic
// one, on nodes that the data can tell apart. Throws Error for flags that contradict each other or
// the measurement.
ModelSpec SpecFromFlags(const Measurement& measurement);

// Nodes to choose from for this model, as --nodes asks for; empty if it does not. Throws Error for
// an isotropic one.
std::vector<NodeCandidate> NodeLadderFromFlags(const ModelSpec& spec,
                                               const Measurement& measurement);

// Throws Error for what no measurement could mend.
void CheckModelFlags();

// Whether one of these flags was given.
bool ModelIsGiven();

// Whether the form of the model is to be chosen by what looks best (--model=auto).
bool ChoosesModel();

std::vector<std::string> ModelFlags();

// GuideOptions::weight.
double GuideFromFlags();

}  // namespace trilobe

#endif  // TRILOBE_APP_MODEL_FLAGS_H_
