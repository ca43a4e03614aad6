#ifndef TRILOBE_APP_FIT_MANY_H_
#define TRILOBE_APP_FIT_MANY_H_

#include <span>
#include <string>
#include <vector>

#include "app/fit_page.h"
#include "app/fit_run.h"

namespace trilobe {

// Reads the outcomes of all fits in the subfolders of a folder, sorted by name. Throws Error if
// there is none.
std::vector<FitOutcome> ReadFitsIn(const std::string& folder);

// Runs `trilobe fit SOURCE... --out=DIR`; a SOURCE may be a folder of measurements. Fits each on a
// thread of its own into DIR/NAME and skips those whose result is already there. Writes
// DIR/fits.csv and DIR/index.html. Returns the exit status: 3 if a fit failed, which does not stop
// the others.
int RunFitOfMany(std::span<const std::string> arguments, FitSettings settings);

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_MANY_H_
