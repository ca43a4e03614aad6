#ifndef TRILOBE_FIT_CHECK_OPTIONS_H_
#define TRILOBE_FIT_CHECK_OPTIONS_H_

#include "trilobe/fit/fit_options.h"

namespace trilobe {

// The options with functions that can be called, and with what `raw` leaves out. Throws Error for
// numbers out of their ranges and for options that contradict each other.
FitOptions CheckOptions(FitOptions options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_CHECK_OPTIONS_H_
