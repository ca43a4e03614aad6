#ifndef TRILOBE_APP_FIT_SETTINGS_H_
#define TRILOBE_APP_FIT_SETTINGS_H_

#include <string>
#include <vector>

#include "app/fit_run.h"

namespace trilobe {

// The flags of `trilobe fit`, without those that only some solvers read.
std::vector<std::string> FitFlags();

// Settings of a fit by the flags as they are now. Pictures and the page only where --plots was
// given. Throws Error for bad values and for flags that exclude each other.
FitSettings FitSettingsFromFlags();

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_SETTINGS_H_
