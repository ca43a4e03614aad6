#ifndef TRILOBE_SOLVERS_SMOOTH_THINNED_FOR_STARTS_H_
#define TRILOBE_SOLVERS_SMOOTH_THINNED_FOR_STARTS_H_

#include "trilobe/objective/objective.h"

namespace trilobe {

// The objective of so few of the samples, about 25 folded ones a parameter where there are so many,
// that it tells minima apart as all of them do. For one thread.
Objective ThinnedForStarts(const Objective& objective);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SMOOTH_THINNED_FOR_STARTS_H_
