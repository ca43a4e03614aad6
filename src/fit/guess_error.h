#ifndef TRILOBE_FIT_GUESS_ERROR_H_
#define TRILOBE_FIT_GUESS_ERROR_H_

#include <optional>

#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// How far an isotropic fit to a table is probably off on the whole sphere, which it must guess in
// part: what was measured differs by `seen`, and the guess is as wrong as a rehearsal of it. By
// sin^4 theta = measured_share the measurement ends at theta. A third of what is beyond is hidden
// at the end of each table as well, the model goes on from there (ContinueBeyondData), and the
// spheres of the two models are compared. It is limited, as a fit is (LimitAlbedo). Both errors add
// up as squares. That is mostly within a factor of 2 of the truth
// (docs/decisions/beyond-the-data.md). `data`: for the model's spec. Nothing if next to all was
// measured. The same bits for any number of threads.
std::optional<WholeSphere> EstimateWholeSphere(const Objective& data, const FactorModel& model,
                                               double measured_share, const SeenError& seen,
                                               const AppearanceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_GUESS_ERROR_H_
