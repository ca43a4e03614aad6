#ifndef TRILOBE_APP_APPEARANCE_FLAGS_H_
#define TRILOBE_APP_APPEARANCE_FLAGS_H_

#include <gflags/gflags_declare.h>

#include "trilobe/model/appearance/appearance.h"

// What lights the spheres of fit, score and plot.
DECLARE_string(probe);

namespace trilobe {

// The light of --probe, or the built-in one, and --threads. Reads the probe at the first call.
AppearanceOptions AppearanceOptionsFromFlags();

}  // namespace trilobe

#endif  // TRILOBE_APP_APPEARANCE_FLAGS_H_
