#ifndef TRILOBE_APP_FIT_FLAGS_H_
#define TRILOBE_APP_FIT_FLAGS_H_

#include <string>
#include <vector>

#include "fit/fit_option.h"

namespace trilobe {

// Defines the flags of AllFitOptions(). Call it before the command line is read.
void DefineFitFlags();

// The flags of all options of a fit, of its form, and of those that scenes take.
std::vector<std::string> FitOptionFlags();
std::vector<std::string> ModelFlags();
std::vector<std::string> SceneFitOptionFlags();

// Whether one of ModelFlags() was given.
bool ModelIsGiven();

// Whether --model=auto was given.
bool ChoosesModel();

// The options of a fit by these flags, --seed, and the solver's. Throws Error for bad values and
// for flags that contradict each other.
FitOptions FitOptionsFromFlags();

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_FLAGS_H_
