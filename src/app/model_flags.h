#ifndef TRILOBE_APP_MODEL_FLAGS_H_
#define TRILOBE_APP_MODEL_FLAGS_H_

#include <optional>
#include <string>
#include <vector>

#include "trilobe/fit/form.h"

namespace trilobe {

// Defines --model, by NamedForms(). Call it before the command line is read.
void DefineModelFlag();

// The form by --model, --lobes, --stretch, --d_nodes, --f_bins, --g_nodes and --nodes. Throws Error
// for values that are invalid for every measurement.
FormOptions FormFromFlags();

// Whether one of these flags was given.
bool ModelIsGiven();

// Whether --model=auto was given.
bool ChoosesModel();

std::vector<std::string> ModelFlags();

// FitOptions::prior.
std::optional<double> PriorFromFlags();

}  // namespace trilobe

#endif  // TRILOBE_APP_MODEL_FLAGS_H_
