#ifndef TRILOBE_FIT_COMPLETE_OPTIONS_H_
#define TRILOBE_FIT_COMPLETE_OPTIONS_H_

#include "trilobe/fit/fit_options.h"

namespace trilobe {

// The options with functions that can be called, and without the steps that `raw` leaves out.
FitOptions CompleteOptions(FitOptions options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_COMPLETE_OPTIONS_H_
