#ifndef TRILOBE_APP_FIT_MANY_H_
#define TRILOBE_APP_FIT_MANY_H_

#include <span>
#include <string>
#include <vector>

#include "app/fit_page.h"
#include "app/fit_run.h"

namespace trilobe {

// What the folders of fits in a folder say of them, by their names. Throws Error where there is
// none.
std::vector<FitOutcome> ReadFitsIn(const std::string& folder);

// `trilobe fit SOURCE... --out=DIR`, where a SOURCE may be a folder of measurements: fits each, on
// a thread of its own, into the folder DIR/NAME, leaves out those of which that folder already has
// what would come out, and gathers all in DIR/fits.csv and DIR/index.html. Returns the exit status:
// 3 if one or more could not be fitted, which does not stop the others.
int RunFitOfMany(std::span<const std::string> arguments, FitSettings settings);

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_MANY_H_
