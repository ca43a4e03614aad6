#ifndef TRILOBE_FIT_FINISH_SHOWN_LIGHT_H_
#define TRILOBE_FIT_FINISH_SHOWN_LIGHT_H_

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Whether some half vectors are farther than 20 degrees from the normal, which tell a diffuse term.
bool ShowsMoreThanHighlight(const BrdfSamples& samples);

// Light that scattered samples themselves show to be reflected, in their units: the largest channel
// of
//   integral of rho(wi, wo) cos theta_o over measured wo,
// its median over theta_i near which there are eight samples, by degrees or, where no
// degree has these, by tens of degrees; rho is that of a model of the samples. Measured are wo up
// to the largest theta of the samples, whose theta_h and theta_d are next to those of a sample.
// So it hardly depends on what a model says between and beyond them. At least pi times the darkest
// sample, which a diffuse base reflects, where some are away from the highlight. 0 for samples
// without directions.
double ShownLight(const BrdfSamples& samples, const FactorModel& model, int num_threads);

// Whether 1 means nothing to samples that show so much light: more is no error of a calibration,
// and less no material, as black velvet reflects 0.004 and little else is darker.
inline constexpr double kMostOfUnits = 1.25, kLeastOfUnits = 0.003;
inline bool IsInOtherUnits(double shown) {
  return shown > kMostOfUnits || (shown > 0 && shown < kLeastOfUnits);
}

// How much light a fit to scattered samples may reflect: 1, of which nothing in 1/sr reflects more,
// or what they show where that is more. As some light remains beside the samples, the limit in
// other units is kOfShown times what they show, so that k times the samples have k times the limit;
// three times that for an isotropic model, which has a limit beyond the data besides
// (AlbedoLimitsOf).
inline constexpr double kOfShown = 2;
double LimitByShown(const BrdfSamples& samples, const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_SHOWN_LIGHT_H_
