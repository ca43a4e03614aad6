#ifndef TRILOBE_FIT_GUESS_ERROR_H_
#define TRILOBE_FIT_GUESS_ERROR_H_

#include <functional>
#include <optional>

#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Estimated error of an isotropic fit to a table on the whole sphere, which it must guess in part:
// what was measured differs by `seen`, and the guess is as wrong as a rehearsal of it. By sin^4
// theta = measured_share the measurement ends at theta. A third of what is beyond is hidden at the
// end of each table as well, the model goes on from there (ContinueBeyondData), and the spheres of
// the two models are compared. It is limited, as a fit is (LimitAlbedo). Both errors add up as
// squares. That is mostly within a factor of 2 of the truth (docs/decisions/beyond-the-data.md).
// `data`: for the model's spec. Nothing if next to all was measured. The same bits for any number
// of threads.
std::optional<WholeSphere> EstimateWholeSphere(const Objective& data, const FactorModel& model,
                                               double measured_share, const SeenError& seen,
                                               const AppearanceOptions& options);

// The same for a fit to nodes. Between them, and beyond, it is off by a quarter of what the model
// differs by from its own values at the measured nodes, interpolated linearly.
WholeSphere EstimateWholeOfNodes(const NodeBrdf& measured, const FactorModel& model,
                                 const SeenError& seen, const AppearanceOptions& options);

// The same for an isotropic fit to scattered samples. It is fitted anew to every other incidence
// (of 10 degrees if there are many), and to the rest. It differs from these halves by about a
// quarter more than it is off by itself: by less where all samples are of the highlight,
// and by more where there are two incidences. Nothing if next to all was measured by no fewer
// samples than `parameters`, for fewer than 32 samples, and for a single incidence. `fit_to`: a
// model of the same spec, fitted to given samples as `model` was to all.
using FitTo = std::function<FactorModel(const BrdfSamples& samples)>;
std::optional<WholeSphere> EstimateWholeOfSamples(const BrdfSamples& samples,
                                                  const FactorModel& model, int parameters,
                                                  double measured_share, const SeenError& seen,
                                                  const FitTo& fit_to,
                                                  const AppearanceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_GUESS_ERROR_H_
