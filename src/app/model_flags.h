#ifndef TRILOBE_APP_MODEL_FLAGS_H_
#define TRILOBE_APP_MODEL_FLAGS_H_

#include <optional>
#include <string>
#include <vector>

#include "trilobe/fit/form.h"

namespace trilobe {

// The form that --model, --lobes, --stretch, --d_nodes, --f_bins, --g_nodes and --nodes ask for.
// Throws Error for what no measurement could mend.
FormOptions FormFromFlags();

// Whether one of these flags was given.
bool ModelIsGiven();

// Whether the form of the model is to be chosen by what looks best (--model=auto).
bool ChoosesModel();

std::vector<std::string> ModelFlags();

// FitOptions::prior.
std::optional<double> PriorFromFlags();

}  // namespace trilobe

#endif  // TRILOBE_APP_MODEL_FLAGS_H_
